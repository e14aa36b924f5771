#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "controller/model/kinematics.h"
#include "tests/support/tiny_robot.h"
#include "world/sensing/sensing.h"

namespace moma::test {

inline std::vector<double> values(const VectorX& v) { return {v.begin(), v.end()}; }

/// How many of the parts that have a disturbance of their own differ in any bit: q, its rate, the base's place,
/// heading, linear and angular velocity; places, turns, linear and angular velocities of objects and of the goal.
inline int parts_that_differ(const Observation& a, const Observation& b) {
  const auto joints = a.q.size();
  int n = 0;
  n += a.q != b.q;
  n += a.qdot.tail(joints) != b.qdot.tail(joints);
  n += a.base.head<2>() != b.base.head<2>();
  n += a.base.z() != b.base.z();
  n += a.qdot.head(1) != b.qdot.head(1);
  n += a.qdot.segment(1, 1) != b.qdot.segment(1, 1);
  bool place = false, turn = false, linear = false, angular = false;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    place = place || a.objects[i].X_WO.translation() != b.objects[i].X_WO.translation();
    turn = turn || a.objects[i].X_WO.linear() != b.objects[i].X_WO.linear();
    angular = angular || a.objects[i].V_WO_W.head<3>() != b.objects[i].V_WO_W.head<3>();
    linear = linear || a.objects[i].V_WO_W.tail<3>() != b.objects[i].V_WO_W.tail<3>();
    n += a.objects[i].visible != b.objects[i].visible;
  }
  n += place + turn + linear + angular;
  n += a.goal.X_WG.translation() != b.goal.X_WG.translation();
  n += a.goal.X_WG.linear() != b.goal.X_WG.linear();
  n += a.goal.V_WG_W.head<3>() != b.goal.V_WG_W.head<3>();
  n += a.goal.V_WG_W.tail<3>() != b.goal.V_WG_W.tail<3>();
  n += a.time != b.time;
  return n;
}

inline Disturbances everything_on() {
  Disturbances d;
  d.joints = {0.001, 0.01, 0.002, 0.04};
  d.base.noise = {0.005, 0.003};
  d.base.velocity_noise = {0.01, 0.01};
  d.base.bias = {0.01, 0.01};
  d.base.delay = 0.06;
  d.base.odometry = {0.02, 0.02, 0.01, {0.005, 0.005}};
  d.objects = {SensingFrame::kBase, {0.01, 0.01}, {0.02, 0.02}, true, {0.01, 0.01}, 0.1};
  d.detection = {2.0, 0.2, {0.0, 0.0, 0.5}, true};
  d.goal = {SensingFrame::kBase, {0.002, 0.002}, {0.01, 0.01}, true, {0.002, 0.002}, 0.04};
  d.actuators = {{0.02, 0.02, {0.05, 0.02}}, {0.04, {0.03, 0.03}}};
  d.payload = {1.5, 0.5, {0.0, 0.0, 0.05}};
  d.floor = {0.7, 0.1};
  return d;
}

/// The tiny robot in a world with two objects or more, on a smooth motion in which no two coordinates are the same.
class SensingRig {
 public:
  explicit SensingRig(const Disturbances& disturbances, std::uint64_t index = 0, std::size_t objects = 2)
      : model_(tiny_robot()) {
    world_.seed = 5;
    world_.index = index;
    world_.objects.resize(objects);
    sensing_ = std::make_unique<Sensing>(disturbances, *model_, world_, 0.02);
  }

  Sensing& sensing() { return *sensing_; }
  const RobotModel& model() const { return *model_; }

  bool further = false;  ///< another goal follows, at the pose of the first

  Observation truth(long k) const {
    const double t = 0.02 * static_cast<double>(k);
    Observation out;
    out.time = t;
    out.base = {1.0 + 0.3 * t, 0.2 * std::sin(t), 0.1 + 0.5 * t};
    out.q = VectorX::LinSpaced(3, 0.1, 0.3) * std::cos(t);
    out.qdot = VectorX::LinSpaced(5, -0.2, 0.3) * std::sin(1.0 + t);
    out.objects.resize(world_.objects.size());
    for (std::size_t i = 0; i < out.objects.size(); ++i) {
      const double o = static_cast<double>(i);
      out.objects[i].X_WO.translation() = Vector3(1.0 + o + 0.1 * t, -0.5 * o, 0.3);
      out.objects[i].X_WO.linear() = Eigen::AngleAxisd(0.2 + o, Vector3(1, 2, 3).normalized()).toRotationMatrix();
      out.objects[i].V_WO_W << 0.1, 0.2, 0.3, 0.1, -0.2 * o, 0.4;
    }
    out.goal.X_WG.translation() = Vector3(2.0, 0.3 * t, 0.8);
    out.goal.X_WG.linear() = Eigen::AngleAxisd(0.7, Vector3(2, 1, 3).normalized()).toRotationMatrix();
    out.goal.V_WG_W << 0.05, 0.06, 0.07, 0.1, 0.3, 0.2;
    if (further) out.next = out.goal;
    return out;
  }

  /// Steps in order from 0.
  Observation sense(long k) {
    Observation out = truth(k);
    sensing_->sense(k, out);
    return out;
  }

  static void expect_same(const Observation& a, const Observation& b) { EXPECT_EQ(parts_that_differ(a, b), 0); }

 private:
  std::shared_ptr<const RobotModel> model_;
  World world_;
  std::unique_ptr<Sensing> sensing_;
};

}  // namespace moma::test
