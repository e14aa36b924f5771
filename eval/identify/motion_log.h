#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace moma::identify {

/// One velocity of a robot over a log: what was commanded and what was measured, one value a row.
struct Axis {
  std::string name;              ///< "base.vx", "base.vy", "base.omega", or a joint's
  bool prismatic = false;        ///< of a joint: m and m/s in place of rad and rad/s
  std::vector<double> command;   ///< sent at the row's time [rad/s or m/s]
  std::vector<double> velocity;  ///< measured, as known at the row's time [rad/s or m/s]
  std::vector<double> position;  ///< of a joint, likewise [rad or m]; empty where the log has none
};

/// Something that was seen at rest.
struct LoggedObject {
  std::string name;
  std::vector<double> x, y, z;  ///< in the world, as measured [m]
  std::vector<double> stamp;    ///< when it was measured [s]; empty where the log does not say
};

/// A log of commands and measured states, one row a control period. In files it is CSV with a head (identify.md).
struct MotionLog {
  std::string source;                                ///< for messages
  std::vector<double> time;                          ///< [s]
  std::vector<Axis> base;                            ///< none, (vx, omega) or (vx, vy, omega), in base axes
  std::vector<double> base_x, base_y, base_heading;  ///< measured pose in the world; all empty or none [m, m, rad]
  std::vector<double> base_stamp;                    ///< when base.* was measured [s]; may be empty
  std::vector<Axis> joints;
  std::vector<double> joint_stamp;  ///< when joints were measured [s]; may be empty
  std::vector<LoggedObject> objects;
  int first_line = 2;  ///< of the first row in the file

  std::size_t rows() const noexcept { return time.size(); }
};

/// Median of the times between rows [s].
double period_of(const MotionLog& log);

/// Throws config::ConfigError naming the line where the times cannot be those of control periods: not growing, or a
/// step off the median by more than half of it; and where there are fewer than 100 rows.
void check_times(const MotionLog& log);

/// Reads a log from CSV: a head with the names of columns, then one row a control period (identify.md). Throws
/// config::ConfigError naming file, line and column: unreadable, unknown, repeated or missing columns, rows of another
/// length, anything that is not a finite number, and what check_times() refuses.
MotionLog read_log(const std::filesystem::path& file);
/// The same from text; `name` stands for the file in messages.
MotionLog parse_log(const std::string& text, const std::string& name);

/// Writes what read_log() takes back, numbers to the last bit.
void write_log(std::ostream& out, const MotionLog& log);

}  // namespace moma::identify
