#include <fmt/format.h>
#include <fmt/ostream.h>

#include <ostream>
#include <utility>

#include "eval/identify/motion_log.h"

namespace moma::identify {

void write_log(std::ostream& out, const MotionLog& log) {
  std::vector<std::pair<std::string, const std::vector<double>*>> columns;
  const auto add = [&columns](std::string name, const std::vector<double>& values) {
    if (!values.empty()) columns.emplace_back(std::move(name), &values);
  };
  add("time_s", log.time);
  add("base.x_m", log.base_x);
  add("base.y_m", log.base_y);
  add("base.heading_rad", log.base_heading);
  add("base.stamp_s", log.base_stamp);
  for (const Axis& axis : log.base) {
    const std::string unit = axis.name == "base.omega" ? "_rad_s" : "_m_s";
    add(axis.name + unit, axis.velocity);
    add("base.command_" + axis.name.substr(5) + unit, axis.command);
  }
  add("joint.stamp_s", log.joint_stamp);
  for (const Axis& axis : log.joints) {
    const std::string name = "joint." + axis.name + ".", unit = axis.prismatic ? "m" : "rad";
    add(name + "position_" + unit, axis.position);
    add(name + "velocity_" + unit + "_s", axis.velocity);
    add(name + "command_" + unit + "_s", axis.command);
  }
  for (const LoggedObject& object : log.objects) {
    const std::string name = "object." + object.name + ".";
    add(name + "x_m", object.x);
    add(name + "y_m", object.y);
    add(name + "z_m", object.z);
    add(name + "stamp_s", object.stamp);
  }
  for (std::size_t i = 0; i < columns.size(); ++i) out << (i == 0 ? "" : ",") << columns[i].first;
  out << '\n';
  for (std::size_t k = 0; k < log.rows(); ++k) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      fmt::print(out, "{}{}", i == 0 ? "" : ",", (*columns[i].second)[k]);
    out << '\n';
  }
}

}  // namespace moma::identify
