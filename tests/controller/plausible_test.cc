#include "controller/config/plausible.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/robots.h"
#include "tests/support/tiny_robot.h"

namespace moma::test {
namespace {

using nlohmann::ordered_json;

std::string all(const RobotModel& model, const ordered_json& resolved = ordered_json::object()) {
  std::string text;
  for (const std::string& sentence : config::implausible(model, resolved)) text += sentence + "\n";
  return text;
}

TEST(Plausible, RobotsThatWorkAreNotDoubted) {
  for (const std::string& robot : all_robots()) {
    if (robot.find("examples/") != std::string::npos || robot.find("tests/") != std::string::npos) continue;
    for (const std::string& warning : config::load_robot(source_path(robot)).warnings)
      EXPECT_EQ(warning.find("unusual"), std::string::npos) << robot << ": " << warning;
  }
  EXPECT_EQ(all(*tiny_robot()), "");
}

TEST(Plausible, DegreesMillimetresAndGramsAreNamed) {
  EXPECT_EQ(all(*tiny_robot(), {{"base", {{"mount", {{"rpy", {0, 0, 90}}}}}}}),
            "base.mount.rpy: 90 rad is unusual, where robots have -6.283 to 6.283 rad: degrees?\n");
  EXPECT_EQ(all(*tiny_robot(), {{"shapes", {{{"rpy", {0, 3.1416, 0}}}, {{"rpy", {180, 0, 0}}}}}}),
            "shapes.1.rpy: 180 rad is unusual, where robots have -6.283 to 6.283 rad: degrees?\n");
  struct Case {
    const char* says;
    void (*change)(RobotModel&);
  };
  const Case cases[] = {
      {"base.mount.position: 150 m is unusual", [](RobotModel& m) { m.base.X_BM.translation().z() = 150; }},
      {"base.wheels.radius: 100 m is unusual, where robots have 0.02 to 0.6 m",
       [](RobotModel& m) { m.base.wheels->radius = 100; }},
      {"base.wheels.separation: 500 m", [](RobotModel& m) { m.base.wheels->separation = 500; }},
      {"base.max_linear: 1000 m/s", [](RobotModel& m) { m.base.max_linear = 1000; }},
      {"base.max_angular: 90 rad/s is unusual, where robots have 0.05 to 12 rad/s: degrees?",
       [](RobotModel& m) { m.base.max_angular = 90; }},
      {"base.max_acceleration: 2000 m/s^2", [](RobotModel& m) { m.base.max_acceleration.x() = 2000; }},
      {"base.footprint.mass: 5e+04 kg", [](RobotModel& m) { m.base.mass = 50000; }},
      {"joint bend: the way from its parent's: 300 m is unusual",
       [](RobotModel& m) { m.links[3].X_PJ.translation().x() = 300; }},
      {"link lower: mass: 2500 kg", [](RobotModel& m) { m.links[3].inertial = Inertial{.mass = 2500}; }},
      {"link lower: inertia: its principal moments, -1, 0.01 and 0.01 kg m^2, are those of no body",
       [](RobotModel& m) { m.links[3].inertial = Inertial{.mass = 1, .I_C = Vector3(-1, 0.01, 0.01).asDiagonal()}; }},
      {"link lower: inertia: its principal moments, 0.01, 0.01 and 100 kg m^2",
       [](RobotModel& m) { m.links[3].inertial = Inertial{.mass = 1, .I_C = Vector3(100, 0.01, 0.01).asDiagonal()}; }},
      {"arm.tool: its distance from the tip: 100 m", [](RobotModel& m) { m.X_TE.translation().z() = 100; }},
      {"base.max_linear: ", [](RobotModel& m) { m.base.wheels->max_speed = 1; }},
      {"base.footprint: its lowest point: -",
       [](RobotModel& m) {
         for (CollisionShape& s : m.shapes)
           if (s.link == 0) s.X_LS.translation().z() -= 0.5;
       }},
      {"base.footprint: its lowest point: ",
       [](RobotModel& m) {
         for (CollisionShape& s : m.shapes)
           if (s.link == 0) s.X_LS.translation().z() += 1.0;
       }},
      {"joint turn: limit: 170 rad is unusual", [](RobotModel& m) { m.joints[0].upper = 170; }},
      {"joint reach: limit: 400 m is unusual", [](RobotModel& m) { m.joints[2].upper = 400; }},
      {"joint turn: velocity: 120 rad/s", [](RobotModel& m) { m.joints[0].velocity = 120; }},
      {"shape slide: size: 50 m is unusual, where robots have 0 to 3 m: millimetres?",
       [](RobotModel& m) { m.shapes[3].shape.size.x() = 50; }},
  };
  for (const Case& c : cases) {
    RobotModel model = *tiny_robot();
    c.change(model);
    const std::string text = all(model);
    EXPECT_NE(text.find(c.says), std::string::npos) << "expected: " << c.says << "\nfound: " << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
}

TEST(Plausible, AFootprintThatFloatsIsSeenBesideWheelsOnTheFloor) {
  RobotModel model = *config::load_robot(source_path("configs/robots/frankie.yaml")).model;
  const ordered_json resolved = {{"base", {{"footprint", ordered_json::object()}}}};
  EXPECT_EQ(all(model, resolved), "");
  const auto footprint =
      std::find_if(model.shapes.begin(), model.shapes.end(), [](const auto& s) { return s.link == 0; });
  for (const double up : {1.0, -1.0}) {
    footprint->X_LS.translation().z() += up;
    EXPECT_NE(all(model, resolved).find("base.footprint: its lowest point: "), std::string::npos) << up;
    footprint->X_LS.translation().z() -= up;
  }
}

}  // namespace
}  // namespace moma::test
