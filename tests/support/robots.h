#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "controller/config/robot_file.h"

namespace moma::test {

/// Robot files that moma ships.
inline std::vector<std::string> shipped_robots() {
  return {"configs/robots/frankie.yaml", "configs/robots/frankie_omni.yaml", "configs/robots/panda.yaml",
          "configs/robots/ur5.yaml", "configs/robots/lift_ur5.yaml"};
}

/// Robot files over URDFs of the package example-robot-data.
inline std::vector<std::string> foreign_robots() {
  return {"configs/robots/examples/panda.yaml", "configs/robots/examples/ur5.yaml",
          "configs/robots/examples/tiago.yaml", "tests/data/robots/pr2_right_arm.yaml",
          "tests/data/robots/talos_left_arm.yaml"};
}

inline std::vector<std::string> all_robots() {
  std::vector<std::string> all = shipped_robots();
  for (const std::string& robot : foreign_robots()) all.push_back(robot);
  return all;
}

inline std::string source_path(const std::string& file) { return std::string(MOMA_SOURCE_DIR) + "/" + file; }

/// Tests of a suite run in one process, which reads each robot once.
inline const config::LoadedRobot& loaded(const std::string& file) {
  static std::map<std::string, config::LoadedRobot> known;
  auto at = known.find(file);
  if (at == known.end()) at = known.emplace(file, config::load_robot(source_path(file))).first;
  return at->second;
}

inline std::shared_ptr<const RobotModel> load_model(const std::string& file) { return loaded(file).model; }

/// frankie.yaml -> frankie, for names of parametrised tests; examples/ and data/ robots get their folder's name.
inline std::string test_name(const std::string& file) {
  std::string name = file.find("examples/") != std::string::npos ? "example_" : "";
  for (std::size_t i = file.rfind('/') + 1; i < file.rfind('.'); ++i) name += file[i];
  return name;
}

}  // namespace moma::test
