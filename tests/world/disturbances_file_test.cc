// The section `disturbances`: read, written, read again; and what is wrong with it, said where it stands.
#include "world/sensing/disturbances_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/config/json_node.h"
#include "tests/world/sensing_support.h"

namespace moma::test {
namespace {

Disturbances read(const std::string& yaml) {
  return read_disturbances(config::parse_yaml(yaml, "suite.yaml"), "disturbances");
}

std::string error(const std::string& yaml) {
  try {
    read(yaml);
  } catch (const config::ConfigError& e) {
    return e.what();
  } catch (const std::exception& e) {
    return std::string("not a ConfigError: ") + e.what();
  }
  return "no error";
}

void expect_error(const std::string& yaml, const std::vector<std::string>& words) {
  const std::string message = error(yaml);
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << yaml << "\n" << message;
}

TEST(DisturbancesFile, ReadsEveryKey) {
  const Disturbances d = read(R"(
seed: 7
joints: {noise: 0.001, velocity_noise: 0.01, bias: 0.002, delay: 0.04}
base:
  noise: {position: 0.005, rotation: 0.003}
  velocity_noise: {linear: 0.01, angular: 0.01}
  bias: {position: 0.01, rotation: 0.01}
  delay: 0.06
  odometry: {distance: 0.02, turn: 0.02, heading: 0.01, walk: {position: 0.005, rotation: 0.005}}
objects:
  frame: base
  noise: {position: 0.01, rotation: 0.01}
  velocity_noise: {linear: 0.02, angular: 0.02}
  resting_is_known: true
  bias: {position: 0.01, rotation: 0.01}
  delay: 0.1
  range: 2
  detection: 0.2
  known_at_start: true
  sensor: [0.1, 0, 0.5]
goal:
  frame: base
  noise: {position: 0.002, rotation: 0.002}
  velocity_noise: {linear: 0.01, angular: 0.01}
  resting_is_known: true
  bias: {position: 0.002, rotation: 0.002}
  delay: 0.04
actuators:
  joints: {delay: 0.02, gain_error: 0.02, friction: {effort: 0.05, spread: 0.02}}
  base: {delay: 0.04, gain_error: {linear: 0.03, angular: 0.03}}
payload: {mass: 1.5, spread: 0.5, position: [0, 0, 0.05]}
floor: {friction: 0.7, spread: 0.1}
)");
  Disturbances expected = everything_on();
  expected.seed = 7;
  expected.detection.sensor[0] = 0.1;
  EXPECT_TRUE(same(d, expected));
  const nlohmann::ordered_json json = to_json(d);
  EXPECT_TRUE(same(read_disturbances(config::node_from_json(json, "resolved"), "disturbances"), d)) << json.dump();
  EXPECT_EQ(to_json(read_disturbances(config::node_from_json(json, "resolved"), "disturbances")), json);
}

TEST(DisturbancesFile, EachKeyAloneSurvivesWritingAndIsAllThatIsWritten) {
  for (const char* yaml : {"joints: {noise: 0.1}",
                           "joints: {velocity_noise: 0.1}",
                           "joints: {bias: 0.1}",
                           "joints: {delay: 0.1}",
                           "base: {noise: {position: 0.1}}",
                           "base: {noise: {rotation: 0.1}}",
                           "base: {velocity_noise: {linear: 0.1}}",
                           "base: {velocity_noise: {angular: 0.1}}",
                           "base: {bias: {position: 0.1}}",
                           "base: {bias: {rotation: 0.1}}",
                           "base: {delay: 0.1}",
                           "base: {odometry: {distance: 0.1}}",
                           "base: {odometry: {turn: 0.1}}",
                           "base: {odometry: {heading: 0.1}}",
                           "base: {odometry: {walk: {position: 0.1}}}",
                           "base: {odometry: {walk: {rotation: 0.1}}}",
                           "objects: {noise: {position: 0.1}}",
                           "objects: {noise: {rotation: 0.1}}",
                           "objects: {velocity_noise: {linear: 0.1}}",
                           "objects: {velocity_noise: {angular: 0.1}}",
                           "objects: {bias: {position: 0.1}}",
                           "objects: {bias: {rotation: 0.1}}",
                           "objects: {delay: 0.1}",
                           "objects: {range: 0.1}",
                           "objects: {detection: 0.1}",
                           "goal: {noise: {position: 0.1}}",
                           "goal: {noise: {rotation: 0.1}}",
                           "goal: {velocity_noise: {linear: 0.1}}",
                           "goal: {velocity_noise: {angular: 0.1}}",
                           "goal: {bias: {position: 0.1}}",
                           "goal: {bias: {rotation: 0.1}}",
                           "goal: {delay: 0.1}",
                           "actuators: {joints: {delay: 0.1}}",
                           "actuators: {joints: {gain_error: 0.1}}",
                           "actuators: {base: {delay: 0.1}}",
                           "actuators: {base: {gain_error: {linear: 0.1}}}",
                           "actuators: {base: {gain_error: {angular: 0.1}}}",
                           "actuators: {joints: {friction: {effort: 0.1}}}",
                           "actuators: {joints: {friction: {spread: 0.1}}}",
                           "joints: {jitter: 0.1}",
                           "joints: {dropout: 0.1}",
                           "joints: {resolution: 0.1}",
                           "joints: {velocity_resolution: 0.1}",
                           "base: {jitter: 0.1}",
                           "base: {dropout: 0.1}",
                           "base: {velocity_resolution: {linear: 0.1}}",
                           "base: {velocity_resolution: {angular: 0.1}}",
                           "base: {odometry: {slip: {rate: 0.1}}}",
                           "objects: {jitter: 0.1}",
                           "objects: {dropout: 0.1}",
                           "objects: {noise_growth: 0.1}",
                           "objects: {field_of_view: 1.5}",
                           "objects: {occlusion: true}",
                           "objects: {missed: {probability: 0.1}}",
                           "objects: {phantoms: {count: 2}}",
                           "goal: {jitter: 0.1}",
                           "goal: {dropout: 0.1}",
                           "goal: {noise_growth: 0.1}",
                           "actuators: {joints: {jitter: 0.1}}",
                           "actuators: {joints: {dropout: 0.1}}",
                           "actuators: {base: {jitter: 0.1}}",
                           "actuators: {base: {dropout: 0.1}}",
                           "actuators: {base: {deadband: {linear: 0.1}}}",
                           "actuators: {base: {deadband: {angular: 0.1}}}",
                           "actuators: {base: {ramps: {speed_up: 0.5}}}",
                           "actuators: {base: {ramps: {slow_down: 0.5}}}",
                           "payload: {mass: 0.1}",
                           "payload: {spread: 0.1, position: [0.1, 0.2, 0.3]}",
                           "floor: {friction: 0.1}",
                           "floor: {friction: 0.0}",
                           "floor: {spread: 0.1}"}) {
    const Disturbances d = read(yaml);
    EXPECT_TRUE(any(d)) << yaml;
    EXPECT_EQ(senses_with_errors(d) + acts_with_errors(d) + moves_with_errors(d), 1) << yaml;
    EXPECT_EQ(to_json(d), config::node_to_json(config::parse_yaml(yaml, "text"))) << yaml;
  }
}

TEST(DisturbancesFile, NothingOnIsNothing) {
  for (const char* yaml :
       {"none", "{}", "joints: {}", "joints: {noise: 0, delay: 0}", "seed: 9",
        "objects: {frame: base, sensor: [1, 2, 3], known_at_start: true, range: .inf}",
        "objects: {mount: hand, axis: [0, 0, 1], lost: true, missed: {duration: 1}, phantoms: {radius: 0.3}}",
        "base: {odometry: {slip: {distance: 0.1}}}", "goal: {frame: base, resting_is_known: true}",
        "payload: {position: [0, 0, 1]}", "floor: {friction: 1}"}) {
    const Disturbances d = read(yaml);
    EXPECT_FALSE(any(d)) << yaml;
    EXPECT_TRUE(to_json(d).is_object() && to_json(d).empty()) << yaml;
  }
}

TEST(DisturbancesFile, RefusesWhatIsWrongAndSaysWhere) {
  expect_error("joints: {nois: 0.1}", {"suite.yaml:1:", "disturbances.joints.nois", "did you mean noise?"});
  expect_error("joint: {noise: 0.1}", {"disturbances.joint", "did you mean joints?"});
  expect_error("joints: {noise: -0.1}", {"disturbances.joints.noise", "-0.1"});
  expect_error("joints: {noise: nan}", {"disturbances.joints.noise", "nan"});
  expect_error("joints: {noise: .inf}", {"disturbances.joints.noise"});
  expect_error("joints: {noise: [0.1]}", {"disturbances.joints.noise"});
  expect_error("joints: {delay: 2.5}", {"disturbances.joints.delay", "2.5", "2"});
  expect_error("joints: 0.1", {"disturbances.joints"});
  expect_error("base: {noise: 0.1}", {"disturbances.base.noise"});
  expect_error("base: {noise: {heading: 0.1}}", {"disturbances.base.noise.heading", "position", "rotation"});
  expect_error("base: {odometry: {distance: 2}}", {"disturbances.base.odometry.distance", "'2'"});
  expect_error("objects: {frame: map}", {"disturbances.objects.frame", "world", "base"});
  expect_error("objects: {range: -1}", {"disturbances.objects.range"});
  expect_error("objects: {detection: .inf}", {"disturbances.objects.detection"});
  expect_error("objects: {sensor: [0, 0]}", {"disturbances.objects.sensor", "3"});
  expect_error("goal: {range: 1}", {"disturbances.goal.range", "unknown key"});
  expect_error("actuators: {base: {gain_error: 0.1}}", {"disturbances.actuators.base.gain_error"});
  expect_error("actuators: {joints: {gain_error: 1.5}}", {"disturbances.actuators.joints.gain_error", "1.5"});
  expect_error("actuators: {joints: {friction: 0.1}}", {"disturbances.actuators.joints.friction", "map"});
  expect_error("actuators: {joints: {friction: {effort: 1}}}", {"joints.friction.effort", "'1'", "0.9"});
  expect_error("payload: {mass: -1}", {"disturbances.payload.mass", "-1"});
  expect_error("payload: {weight: 1}", {"disturbances.payload.weight", "mass"});
  expect_error("payload: {position: [0, 0]}", {"disturbances.payload.position", "3"});
  expect_error("floor: {friction: -0.1}", {"disturbances.floor.friction", "-0.1"});
  expect_error("joints: {dropout: 1.5}", {"disturbances.joints.dropout", "1.5"});
  expect_error("objects: {field_of_view: 0}", {"disturbances.objects.field_of_view", "'0'"});
  expect_error("objects: {mount: head}", {"disturbances.objects.mount", "base", "hand"});
  expect_error("objects: {phantoms: {count: 100}}", {"disturbances.objects.phantoms.count", "100"});
  expect_error("actuators: {base: {ramps: {slow_down: 0}}}", {"disturbances.actuators.base.ramps.slow_down", "'0'"});
  expect_error("seed: -1", {"disturbances.seed"});
  expect_error("seed: 4294967296", {"disturbances.seed"});
  expect_error("off", {"disturbances", "found 'off'", "none"});
  expect_error("gone.yaml", {"disturbances", "no such file", "gone.yaml"});
  expect_error("[1, 2]", {"disturbances"});
}

TEST(DisturbancesFile, TheShippedOnesAreGood) {
  for (const char* name : {"realistic.yaml", "dead-reckoning.yaml", "harsh.yaml"}) {
    const Disturbances d =
        read_disturbances(config::load_yaml(std::string(MOMA_SOURCE_DIR) + "/configs/disturbances/" + name), "");
    EXPECT_TRUE(senses_with_errors(d)) << name;
    EXPECT_TRUE(acts_with_errors(d)) << name;
  }
}

}  // namespace
}  // namespace moma::test
