// Controller files: defaults, exact round trips, and what every kind of mistake is told.

#include <gtest/gtest.h>

#include <fstream>

#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/controller.h"
#include "controller/describe/equal.h"
#include "controller/params_described.h"
#include "controller/solver/solver.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;
using config::ConfigError;

class ControllerFile : public ::testing::Test {
 protected:
  ControllerParams read(const std::string& text, double period = 0.02) {
    warnings_.clear();
    return config::read_controller(config::parse_yaml(text, "c.yaml"), "controller", *model_, period, warnings_);
  }
  std::string error(const std::string& text, double period = 0.02) {
    try {
      read(text, period);
    } catch (const ConfigError& e) {
      return e.what();
    } catch (const std::exception& e) {
      return std::string("not a ConfigError: ") + e.what();
    }
    return "no error";
  }
  void expect_error(const std::string& text, const std::string& place, const std::string& says, double period = 0.02) {
    const std::string message = error(text, period);
    EXPECT_EQ(message.substr(0, place.size()), place) << message;
    EXPECT_NE(message.find(says), std::string::npos) << message;
  }

  std::shared_ptr<const RobotModel> model_ = frankie();
  std::vector<std::string> warnings_;
};

TEST_F(ControllerFile, EmptyIsTheDefaults) {
  const ControllerParams p = read("{}");
  EXPECT_EQ(p.method, Method::kQp);
  EXPECT_EQ(p.servo.position, 1.5);
  EXPECT_EQ(p.servo.orientation, 1.95);
  EXPECT_EQ(p.servo.max_linear, kInfinity);
  EXPECT_EQ(p.error_norm.kind, ErrorNormKind::kEuclidean);
  EXPECT_EQ(p.error_norm.min, 0.001);
  EXPECT_EQ(p.error_norm.max, 10);
  EXPECT_TRUE(p.base_weight.inverse_error);
  EXPECT_EQ(p.lambda_q, VectorX::Constant(7, 0.01));
  EXPECT_TRUE(p.slack.enabled && p.slack.weight.inverse_error);
  EXPECT_EQ(p.slack.limit, Vector6::Constant(10));
  EXPECT_EQ(p.tracking_band, Vector6::Zero());
  EXPECT_EQ(p.k_epsilon, 0.5);
  EXPECT_EQ(p.manipulability.weight, 1);
  EXPECT_EQ(p.manipulability.rows, ManipulabilityRows::kTranslation);
  EXPECT_EQ(p.joint_limits.method, JointLimitMethod::kSource);
  EXPECT_TRUE(p.joint_limits.margin.automatic);
  EXPECT_EQ(p.joint_limits.margin.value, VectorX::Constant(7, 0.3));
  EXPECT_EQ(p.collision.object.influence, 0.3);
  EXPECT_EQ(p.collision.object.stop, 0.05);
  EXPECT_EQ(p.collision.max_pairs, 30);
  EXPECT_EQ(p.collision.floor.influence, 0.1);
  EXPECT_EQ(p.collision.self.stop, 0.01);
  EXPECT_EQ(p.acceleration_weight, VectorX::Zero(9));
  EXPECT_EQ(p.posture.weight, 0);
  EXPECT_EQ(p.posture.target.value, model_->ready);
  EXPECT_EQ(p.acceleration_limit, VectorX::Constant(9, kInfinity));
  EXPECT_FALSE(p.output_scaling.enabled);
  EXPECT_EQ(p.solver, SolverKind::kDaqp);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ControllerFile, SharesTheJointsOwnAccelerationsWhereKnown) {
  RobotModel model = *model_;
  for (ControlledJoint& joint : model.joints) joint.acceleration = kInfinity;
  model.joints[1].acceleration = 7.5;
  const auto limits = [&](const char* text) { return resolved(read(text), model).acceleration_limit; };
  VectorX expected = VectorX::Constant(9, 5.0);
  EXPECT_EQ(limits("limits: {acceleration: 5}"), expected);
  expected[3] = 6.0;
  EXPECT_EQ(limits("limits: {acceleration: 5, joints: 0.8}"), expected);
}

TEST_F(ControllerFile, ReadsEveryForm) {
  const ControllerParams p = read(R"(
method: park
servo: {position: 0, max_linear: .inf, max_angular: 1.5}
error_norm: {kind: pose, min: 0.01, max: 5, scale: 0.3}
base_weight: 0.1
lambda_q: [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07]
slack: {weight: 100, limit: [1, 2, 3, 4, 5, .inf]}
tracking_band: [0, 0, 0, 0.1, 0.1, 0.1]
manipulability: {rows: all}
joint_limits: {margin: [0.1, 0.2, 0.3, 0.4, 0.3, 0.2, 0.1]}
collision: {enabled: false, max_pairs: 0, floor: {enabled: false}, self: {influence: 0.2}}
acceleration: {weight: 0.5}
posture: {weight: 0.1, target: [0, 0, 0, -1, 0, 1, 0]}
limits: {acceleration: [1, 2, .inf, 4, 5, 6, 7, 8, 9]}
output_scaling: {near: 2}
)");
  EXPECT_EQ(p.method, Method::kPark);
  EXPECT_EQ(p.base_weight.value, 0.1);
  EXPECT_FALSE(p.base_weight.inverse_error);
  EXPECT_EQ(p.lambda_q[6], 0.07);
  EXPECT_EQ(p.slack.limit[5], kInfinity);
  EXPECT_EQ(p.tracking_band[3], 0.1);
  EXPECT_FALSE(p.joint_limits.margin.automatic);
  EXPECT_EQ(p.joint_limits.margin.value[3], 0.4);
  EXPECT_FALSE(p.collision.object.enabled);
  EXPECT_EQ(p.collision.self.influence, 0.2);
  EXPECT_EQ(p.acceleration_weight[8], 0.5);
  EXPECT_EQ(p.posture.target.value[3], -1);
  EXPECT_FALSE(p.posture.target.ready);
  EXPECT_EQ(p.acceleration_limit[2], kInfinity);
  EXPECT_TRUE(p.output_scaling.enabled);
  EXPECT_EQ(p.output_scaling.near, 2);
  EXPECT_EQ(p.output_scaling.far, 0.7);
  EXPECT_FALSE(p.collision.evasion.enabled);
  EXPECT_FALSE(read("collision: {evasion: none}").collision.evasion.enabled);
  EXPECT_TRUE(read("collision: {evasion: {horizon: 3}}").collision.evasion.enabled);
  EXPECT_FALSE(read("slack: none").slack.enabled);
  EXPECT_EQ(read("joint_limits: none").joint_limits.method, JointLimitMethod::kNone);
  EXPECT_EQ(read("joint_limits: {method: damper}").joint_limits.method, JointLimitMethod::kDamper);
}

TEST_F(ControllerFile, RoundTripIsExact) {
  Rng rng(31);
  for (int trial = 0; trial < 100; ++trial) {
    ControllerParams p;
    p.method = static_cast<Method>(rng() % 4);
    p.servo = {uniform(rng, 0, 5), uniform(rng, 0, 5), rng() % 2 ? kInfinity : uniform(rng, 0.1, 2), kInfinity};
    p.error_norm = {static_cast<ErrorNormKind>(rng() % 3), 1e-3 / 3, 10.0 / 3, uniform(rng, 0, 1)};
    p.base_weight = rng() % 2 ? Weight{} : Weight{false, uniform(rng, 0, 1)};
    p.lambda_q = VectorX::NullaryExpr(7, [&] { return uniform(rng, 0.01, 0.1); });
    p.slack.enabled = rng() % 3 != 0;
    p.slack.weight = rng() % 2 ? Weight{} : Weight{false, uniform(rng, 0, 1)};
    p.slack.limit[2] = rng() % 2 ? kInfinity : uniform(rng, 1, 2);
    p.tracking_band.setConstant(uniform(rng, 0, 0.1));
    p.joint_limits.method = static_cast<JointLimitMethod>(rng() % 3);
    if (rng() % 2) {
      p.joint_limits.margin = {false, VectorX::NullaryExpr(7, [&] { return uniform(rng, 0.1, 0.4); })};
    }
    p.collision.object.gain = uniform(rng, 0.1, 2);
    p.collision.floor.enabled = rng() % 2;
    if (p.method == Method::kQp && rng() % 2) p.collision.evasion = {true, uniform(rng, 1, 9), uniform(rng, 0.01, 0.2)};
    p.acceleration_limit = VectorX::Constant(9, rng() % 2 ? kInfinity : uniform(rng, 1, 9));
    p.posture.weight = uniform(rng, 0, 1);
    if (rng() % 2) {
      p.posture.target = {false, VectorX::NullaryExpr(7, [&] { return uniform(rng, -1, 1); })};
    }
    p.output_scaling.enabled = rng() % 2;
    p = resolved(p, *model_);
    const std::string text = config::to_json(p).dump();
    const ControllerParams back = read(text);
    EXPECT_EQ(config::to_json(back).dump(), text);
    ControllerParams expected = p;  // but for the values of what is off and written as none or not at all
    if (!p.slack.enabled) expected.slack = back.slack;
    EXPECT_TRUE(same(back, expected)) << text;
    std::vector<std::string> warnings;
    const ControllerParams node =
        config::read_controller(config::node_from_json(config::to_json(p), "store"), "", *model_, 0.02, warnings);
    EXPECT_EQ(config::to_json(node).dump(), text);
  }
}

// What stores hold of earlier trials is hashed into their keys: it is read and written again to the same bytes.
TEST_F(ControllerFile, WhatEarlierTrialsWroteKeepsItsBytes) {
  std::ifstream in(MOMA_SOURCE_DIR "/tests/data/golden/controllers.jsonl");
  int count = 0;
  for (std::string line; std::getline(in, line); ++count) {
    const nlohmann::ordered_json json = nlohmann::ordered_json::parse(line);
    std::vector<std::string> warnings;
    const ControllerParams p =
        config::read_controller(config::node_from_json(json, "store"), "", *model_, 0.02, warnings);
    EXPECT_EQ(config::to_json(p).dump(), line);
  }
  EXPECT_EQ(count, 14);
}

TEST_F(ControllerFile, PartsThatAreOffKeepTheirValuesWhereTheFileHasThem) {
  ControllerParams p = read(R"(
slack: {enabled: false, weight: 7}
collision: {enabled: false, influence: 0.4, evasion: {enabled: false, horizon: 6}}
output_scaling: {enabled: false, far: 2}
escape: {enabled: false, angle: 1.5}
)");
  EXPECT_FALSE(p.slack.enabled || p.collision.object.enabled || p.collision.evasion.enabled ||
               p.output_scaling.enabled || p.escape.enabled);
  EXPECT_EQ(p.slack.weight.value, 7);
  EXPECT_EQ(p.collision.evasion.horizon, 6);
  EXPECT_EQ(p.output_scaling.far, 2);
  // The resolved JSON has those of escape and of the dampers; the others are written as none, or not at all.
  ControllerParams back = read(config::to_json(p).dump());
  EXPECT_FALSE(same(back, p));
  EXPECT_EQ(back.escape.angle, 1.5);
  EXPECT_EQ(back.collision.object.influence, 0.4);
  EXPECT_EQ(back.collision.evasion.horizon, EvasionParams{}.horizon);
  back.slack = p.slack;
  back.collision.evasion = p.collision.evasion;
  back.output_scaling = p.output_scaling;
  EXPECT_TRUE(same(back, p));
}

TEST_F(ControllerFile, MistakesAreNamedWithTheirPlace) {
  expect_error("methd: qp", "c.yaml:1:1: controller.methd:", "did you mean method?");
  expect_error("method: mpc", "c.yaml:1:9: controller.method:", "qp, rrmc, park, baur");
  expect_error("servo: 3", "c.yaml:1:8: controller.servo:", "expected a map");
  expect_error("servo: {position: fast}", "c.yaml:1:19: controller.servo.position:", "'fast'");
  expect_error("servo: {position: -1}", "c.yaml:1:19: controller.servo.position:", "at least 0");
  expect_error("servo: {position: .nan}", "c.yaml:1:19: controller.servo.position:", "'.nan'");
  expect_error("servo: {position: .inf}", "c.yaml:1:19: controller.servo.position:", "at least 0");
  expect_error("servo: {max_linear: 0}", "c.yaml:1:21: controller.servo.max_linear:", "above 0");
  expect_error("error_norm: {kind: l2}", "c.yaml:1:20: controller.error_norm.kind:", "euclidean, l1, pose");
  expect_error("error_norm: {min: 0}", "c.yaml:1:19: controller.error_norm.min:", "above 0");
  expect_error("error_norm: {min: 11}", "c.yaml:1:19: controller.error_norm.min:", "must not be above");
  expect_error("base_weight: inverse", "c.yaml:1:14: controller.base_weight:", "inverse_error or a number");
  expect_error("base_weight: -0.1", "c.yaml:1:14: controller.base_weight:", "at least 0");
  expect_error("collision: {evasion: {margin: 0}}", "c.yaml:1:31: controller.collision.evasion.margin:", "above 0");
  expect_error("collision: {evasion: on}", "c.yaml:1:22: controller.collision.evasion:", "expected a map");
  expect_error("lambda_q: [1, 2]", "c.yaml:1:11: controller.lambda_q:", "a list of 7 numbers");
  expect_error("lambda_q: [1, 2, 3, 4, 5, 6, x]", "c.yaml:1:30: controller.lambda_q[6]:", "'x'");
  expect_error("slack: off", "c.yaml:1:8: controller.slack:", "expected a map");
  expect_error("slack: {limit: [1, 2, 3]}", "c.yaml:1:16: controller.slack.limit:", "a list of 6 numbers");
  expect_error("slack: {limit: 0}", "c.yaml:1:16: controller.slack.limit:", "above 0");
  expect_error("tracking_band: -1", "c.yaml:1:16: controller.tracking_band:", "at least 0");
  expect_error("manipulability: {rows: six}",
               "c.yaml:1:24: controller.manipulability.rows:", "translation, rotation, all");
  expect_error("joint_limits: {method: soft}",
               "c.yaml:1:24: controller.joint_limits.method:", "source, damper, braking, none");
  expect_error("joint_limits: {margin: 0}", "c.yaml:1:24: controller.joint_limits.margin:", "above 0");
  expect_error("joint_limits: {margin: 0.04}",
               "c.yaml:1:24: controller.joint_limits.margin:", "velocity limit x control period");
  expect_error("joint_limits: {margin: 2}", "c.yaml:1:24: controller.joint_limits.margin:", "half the joint's range");
  expect_error("{}", "c.yaml:1:1: controller.joint_limits.margin:", "velocity limit x control period", 0.2);
  expect_error("joint_limits: {method: damper, stop: 1}", "c.yaml:1:38: controller.joint_limits.stop:", "below");
  expect_error("joint_limits: {method: damper, influence: 0.04, stop: 0.01}",
               "c.yaml:1:43: controller.joint_limits.influence:", "overshoot");
  // A look ahead takes steps of its own.
  expect_error("joint_limits: {method: damper, influence: 0.06, stop: 0.01}\nplan: {enabled: true, step: 0.04}",
               "c.yaml:1:43: controller.joint_limits.influence:", "velocity limit x plan.step");
  expect_error("plan: {decisions: {wait: 3}}", "c.yaml:1:26: controller.plan.decisions.wait:", "below meet");
  expect_error("plan: {search: {base_alone: 0.7}}", "c.yaml:1:16: controller.plan.search:", "not exceed 1");
  expect_error("plan: {search: {hand_moves: 1.5}}", "c.yaml:1:29: controller.plan.search.hand_moves:", "from 0 to 1");
  expect_error("joint_limits: {method: damper, gain: 50}", "c.yaml:1:38: controller.joint_limits.gain:", "overshoots");
  expect_error("collision: {stop: 0.3}", "c.yaml:1:19: controller.collision.stop:", "below collision.influence");
  expect_error("collision: {max_pairs: 2.5}", "c.yaml:1:24: controller.collision.max_pairs:", "whole number");
  expect_error("collision: {max_pairs: -1}", "c.yaml:1:24: controller.collision.max_pairs:", "from 0");
  expect_error("collision: {floor: {gain: 0}}", "c.yaml:1:27: controller.collision.floor.gain:", "above 0");
  expect_error("collision: {floor: {max_pairs: 3}}",
               "c.yaml:1:21: controller.collision.floor.max_pairs:", "unknown key");
  expect_error("collision: {self: {stop: 0.2}}", "c.yaml:1:26: controller.collision.self.stop:", "below");
  expect_error("acceleration: {weight: [1]}", "c.yaml:1:24: controller.acceleration.weight:", "a list of 9 numbers");
  expect_error("posture: {target: home}", "c.yaml:1:19: controller.posture.target:", "ready or a list of 7");
  expect_error("posture: {target: [0]}", "c.yaml:1:19: controller.posture.target:", "a list of 7 numbers");
  expect_error("limits: {acceleration: 0}", "c.yaml:1:24: controller.limits.acceleration:", "above 0");
  expect_error("limits: {velocity: 1}", "c.yaml:1:10: controller.limits.velocity:", "unknown key");
  expect_error("output_scaling: {far: 0}", "c.yaml:1:23: controller.output_scaling.far:", "above 0");
  expect_error("solver: qpoases", "c.yaml:1:9: controller.solver:", "daqp");
  expect_error("method: park\nlambda_q: 0", "c.yaml:2:11: controller.lambda_q:", "divide by it");
  expect_error("[1, 2]", "c.yaml:1:1: controller:", "expected a map");
  expect_error("none.yaml", "c.yaml:1:1: controller:", "no file");
}

// The search for gains tries one alone: what is wrong with it whatever the others are is told apart from
// contradictions.
TEST_F(ControllerFile, ErrorsOfOneKeyAreToldApartFromContradictions) {
  EXPECT_THROW(read("methd: qp"), config::KeyError);
  EXPECT_THROW(read("servo: {position: -1}"), config::KeyError);
  EXPECT_THROW(read("collision: {evasion: {horizon: soon}}"), config::KeyError);
  for (const char* text : {"collision: {stop: 0.3}", "error_norm: {min: 11}", "joint_limits: {margin: 2}"}) {
    try {
      read(text);
      ADD_FAILURE() << text << " is accepted";
    } catch (const config::KeyError& e) {
      ADD_FAILURE() << "taken for an error of the key alone: " << e.what();
    } catch (const config::ConfigError&) {
    }
  }
}

TEST_F(ControllerFile, AFreeSlackIsAllowedWithOneWarning) {
  EXPECT_FALSE(read("slack: {weight: 0}").slack.weight.inverse_error);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("c.yaml:1:17: controller.slack.weight"), std::string::npos) << warnings_[0];
}

TEST_F(ControllerFile, ACheckBeyondItsRowsIsAWarning) {
  read("{collision: {stop: 0.02, check: {margin: 0.02}}}");
  EXPECT_TRUE(warnings_.empty());
  read("{collision: {stop: 0.015, check: {margin: 0.02}}}");
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("controller.collision.check.margin: warning: of 0.02 is above collision.stop = 0.015"),
            std::string::npos)
      << warnings_[0];
}

TEST_F(ControllerFile, MarginsAreCheckedPerJoint) {
  // The lift of 0.35 m: a quarter of its range by default; 0.3 cannot work there.
  model_ = mecanum();
  EXPECT_NEAR(read("{}").joint_limits.margin.value[0], 0.0875, 1e-12);
  expect_error("joint_limits: {margin: 0.3}", "c.yaml:1:24:", "joint1");
  EXPECT_NO_THROW(read("joint_limits: {margin: [0.1, 0.3, 0.3, 0.3, 0.3, 0.3]}"));
}

}  // namespace
}  // namespace moma
