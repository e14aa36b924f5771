#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "controller/config/paths.h"

namespace moma::identify {

/// One velocity of a robot over a log: commands and measurements, one value per row.
struct Axis {
  std::string name;              ///< "base.vx", "base.vy", "base.omega", or a joint's
  bool prismatic = false;        ///< units m and m/s instead of rad and rad/s
  std::vector<double> command;   ///< sent at the row's time [rad/s or m/s]
  std::vector<double> velocity;  ///< measured, as known at the row's time [rad/s or m/s]
  /// Measured position of a joint, as known at the row's time [rad or m]; empty if not in the log.
  std::vector<double> position;
};

struct LoggedObject {
  std::string name;
  std::vector<double> x, y, z;  ///< measured position in the world [m]
  std::vector<double> stamp;    ///< time of measurement [s]; empty without stamps
};

/// A log of commands and measured states, one row per control period. Its file form is CSV with a header (identify.md).
struct MotionLog {
  std::string source;                                ///< for messages
  std::vector<double> time;                          ///< [s]
  std::vector<Axis> base;                            ///< none, (vx, omega) or (vx, vy, omega), in base axes
  std::vector<double> base_x, base_y, base_heading;  ///< measured pose in the world; all empty or none [m, m, rad]
  std::vector<double> base_stamp;                    ///< time of measurement of base.* [s]; may be empty
  std::vector<Axis> joints;
  std::vector<double> joint_stamp;  ///< time of measurement of joints [s]; may be empty
  std::vector<LoggedObject> objects;
  int first_line = 2;  ///< line of the first row in the file

  std::size_t rows() const noexcept { return time.size(); }
};

/// Returns the median of the times between rows [s].
double period_of(const MotionLog& log);

/// Throws config::ConfigError with the line if times do not increase, or if a step differs from the median by more than
/// half of it; also for fewer than 100 rows.
void check_times(const MotionLog& log);

/// Reads a log from CSV: a head with the names of columns, then one row a control period (identify.md). Throws
/// config::ConfigError naming file, line and column: unreadable, unknown, repeated or missing columns, rows of another
/// length, anything that is not a finite number, and what check_times() refuses.
MotionLog read_log(const fs::path& file);
/// The same from text; `name` stands for the file in messages.
MotionLog parse_log(const std::string& text, const std::string& name);

/// Writes what read_log() takes back, numbers to the last bit.
void write_log(std::ostream& out, MotionLog log);

/// A column of the file form.
struct LogColumn {
  std::string name;
  std::vector<double>* values;  ///< in the log; empty if the file lacks the column
};
/// Returns the columns of the log's base axes, joints and objects, in the order of write_log().
std::vector<LogColumn> columns_of(MotionLog& log);

}  // namespace moma::identify
