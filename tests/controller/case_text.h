#pragma once

// Cases of robots and controllers of configs/, and files of them as text.

#include <nlohmann/json.hpp>
#include <string>

#include "controller/case/case_file.h"
#include "controller/config/controller_file.h"
#include "controller/config/robot_file.h"

namespace moma::test {

inline ControlCase case_of(const std::string& robot, const std::string& controller) {
  ControlCase c;
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  c.robot = config::load_robot(configs + "robots/" + robot);
  c.controller = config::read_controller(config::load_yaml(configs + "controllers/" + controller), "controller",
                                         *c.robot.model, c.control_period, c.warnings);
  return c;
}

inline ControlCase read_text(const nlohmann::ordered_json& json) {
  return read_case(config::parse_yaml(json.dump(), "case.json"));
}

/// What is said against such a file; "" where it is good.
inline std::string error_of(const nlohmann::ordered_json& json) {
  try {
    read_text(json);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "";
}

}  // namespace moma::test
