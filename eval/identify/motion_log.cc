#include "eval/identify/motion_log.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "controller/config/node.h"

namespace moma::identify {
namespace {

constexpr std::size_t kLeastRows = 100;

}  // namespace

double period_of(const MotionLog& log) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < log.rows(); ++k) steps.push_back(log.time[k] - log.time[k - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void check_times(const MotionLog& log) {
  const auto line = [&](std::size_t row) {
    return config::Mark{log.source, log.first_line + static_cast<int>(row), 0};
  };
  if (log.rows() < kLeastRows) {
    config::fail({log.source, 0, 0}, "",
                 fmt::format("the log has {} rows; at least {} are needed, better 20 s of varied motion", log.rows(),
                             kLeastRows));
  }
  for (std::size_t k = 1; k < log.rows(); ++k) {
    if (log.time[k] > log.time[k - 1]) continue;
    config::fail(line(k), "time_s",
                 fmt::format("{} s comes after {} s: times have to grow", log.time[k], log.time[k - 1]));
  }
  const double period = period_of(log);
  for (std::size_t k = 1; k < log.rows(); ++k) {
    const double step = log.time[k] - log.time[k - 1];
    if (std::abs(step - period) <= 0.5 * period) continue;
    config::fail(
        line(k), "time_s",
        fmt::format("{:.6g} s after the row before, where the control period is {:.6g} s (the median): one row "
                    "a period is needed, within half of it",
                    step, period));
  }
}

std::vector<LogColumn> columns_of(MotionLog& log) {
  std::vector<LogColumn> columns{{"time_s", &log.time},
                                 {"base.x_m", &log.base_x},
                                 {"base.y_m", &log.base_y},
                                 {"base.heading_rad", &log.base_heading},
                                 {"base.stamp_s", &log.base_stamp}};
  for (Axis& axis : log.base) {
    const std::string unit = axis.name == "base.omega" ? "_rad_s" : "_m_s";
    columns.push_back({axis.name + unit, &axis.velocity});
    columns.push_back({"base.command_" + axis.name.substr(5) + unit, &axis.command});
  }
  columns.push_back({"joint.stamp_s", &log.joint_stamp});
  for (Axis& axis : log.joints) {
    const std::string name = "joint." + axis.name + ".", unit = axis.prismatic ? "m" : "rad";
    columns.push_back({name + "position_" + unit, &axis.position});
    columns.push_back({name + "velocity_" + unit + "_s", &axis.velocity});
    columns.push_back({name + "command_" + unit + "_s", &axis.command});
  }
  for (LoggedObject& object : log.objects) {
    const std::string name = "object." + object.name + ".";
    columns.push_back({name + "x_m", &object.x});
    columns.push_back({name + "y_m", &object.y});
    columns.push_back({name + "z_m", &object.z});
    columns.push_back({name + "stamp_s", &object.stamp});
  }
  return columns;
}

void write_log(std::ostream& out, MotionLog log) {
  std::vector<LogColumn> columns = columns_of(log);
  std::erase_if(columns, [](const LogColumn& column) { return column.values->empty(); });
  for (std::size_t i = 0; i < columns.size(); ++i) out << (i == 0 ? "" : ",") << columns[i].name;
  out << '\n';
  for (std::size_t k = 0; k < log.rows(); ++k) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      fmt::print(out, "{}{}", i == 0 ? "" : ",", (*columns[i].values)[k]);
    out << '\n';
  }
}

}  // namespace moma::identify
