#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "eval/suite/suite.h"

namespace moma::test {

/// A folder of its own with a robot (base, two joints), a controller and suites as a test writes them.
class SuiteFolder {
 public:
  SuiteFolder() {
    static int count = 0;
    root_ = std::filesystem::temp_directory_path() /
            ("moma_suite_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(root_ / "robots");
    std::filesystem::create_directories(root_ / "controllers");
    write("robots/tiny.urdf", R"(<robot name="tiny">
  <link name="root"/>
  <link name="upper"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="slide"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="root"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1.5" effort="80"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1.5" effort="80"/></joint>
  <joint name="reach" type="prismatic"><parent link="lower"/><child link="slide"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-0.2" upper="0.4" velocity="0.5" effort="80"/></joint>
</robot>
)");
    write("robots/tiny.yaml", R"(urdf: tiny.urdf
base:
  type: differential
  mount: {position: [0, 0, 0.6]}
  max_linear: 1.0
  max_angular: 2.0
  wheels: {radius: 0.1, separation: 0.4, max_speed: 20}
  footprint: {shape: box, size: [0.5, 0.5, 0.3], position: [0, 0, 0.2], mass: 50}
arm: {tip: slide, tool: {position: [0.3, 0, 0]}, ready: [0, 0, 0]}
collision:
  shapes:
    - {link: upper, shape: capsule, size: [0.05, 0.2], position: [0.15, 0, 0], rpy: [0, 1.5707963, 0]}
    - {link: slide, shape: capsule, size: [0.04, 0.2], position: [0.2, 0, 0], rpy: [0, 1.5707963, 0]}
  self: [[upper, slide]]
)");
    write("controllers/plain.yaml", "lambda_q: 0.01\nservo: {position: 1.5}\n");
  }
  ~SuiteFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  SuiteFolder(const SuiteFolder&) = delete;
  SuiteFolder& operator=(const SuiteFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(root_ / name) << text;
    return root_ / name;
  }
  const std::filesystem::path& root() const { return root_; }

  /// A suite with the given lines after the usual ones.
  std::filesystem::path suite(const std::string& more = "",
                              const std::string& controllers = "{plain: controllers/plain.yaml}") const {
    return write("suite.yaml", "name: tiny\nrobot: robots/tiny.yaml\ncontrollers: " + controllers +
                                   "\nworlds: {seed: 3, families: {open: {weight: 1}}}\n"
                                   "simulation: {mode: kinematic, time_limit: 6}\ntrials: 10\n" +
                                   more);
  }

 private:
  std::filesystem::path root_;
};

}  // namespace moma::test
