// Told by depth alone: frames against the distance of each ray, their errors and lateness, the map that the controller
// makes of them, and a step that takes no memory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "controller/config/controller_file.h"
#include "controller/controller_core.h"
#include "tests/support/no_alloc.h"
#include "tests/support/robots.h"
#include "tests/world/support.h"
#include "world/sensing/depth.h"

namespace moma::test {
namespace {

constexpr double kStep = 0.02;

const std::shared_ptr<const RobotModel>& robot_with_cameras() {
  static const std::shared_ptr<const RobotModel> model = load_model("configs/robots/frankie_cameras.yaml");
  return model;
}

World room() {
  World world;
  world.objects = {solid("box", ShapeKind::kBox, {0.3, 0.4, 1.0}, {1.4, 0.2, 0.5}),
                   solid("ball", ShapeKind::kSphere, {0.15, 0, 0}, {-0.5, 1.2, 0.6}),
                   solid("post", ShapeKind::kCylinder, {0.06, 1.4, 0}, {-1.3, -0.6, 0.7})};
  return world;
}

std::vector<ObjectState> states_of(const World& world) {
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);
  return states;
}

/// Takes all frames, or only counts them.
struct Witness final : StepController {
  void reset(std::span<const ObjectShape>) override {}
  void step(const Observation&, StepResult&) noexcept override {}
  void prepare(StepResult&) const override {}
  void see(const DepthFrame& frame) noexcept override { frames.push_back(frame); }
  Gaze gaze(int) const noexcept override { return looks; }
  std::vector<DepthFrame> frames;
  Gaze looks;
};

/// A robot that stands among the room's objects, its sensors, and what is made of them.
struct Rig {
  explicit Rig(const Disturbances& disturbances = {}, const World& world = room(),
               const std::shared_ptr<const RobotModel>& model = robot_with_cameras())
      : states(states_of(world)), q(model->ready) {
    std::vector<Shape> shapes;
    for (const WorldObject& object : world.objects) shapes.push_back(object.shape);
    sensing.emplace(disturbances, *model, shapes, DisturbanceStreams(world, 0), kStep);
  }
  /// The frames that arrive; heads turn to `looks`.
  std::vector<DepthFrame> frames(long k, const Gaze& looks = {}) {
    sensing->sense(k, base, q, states);
    Witness witness;
    witness.looks = looks;
    sensing->show(witness);
    return witness.frames;
  }
  Vector3 base = Vector3::Zero();
  std::vector<ObjectState> states;
  VectorX q;
  std::optional<DepthSensing> sensing;
};

TEST(DepthSensing, ARayEndsOnTheNearestOfObjectsRobotAndFloor) {
  const World world = room();
  const RobotModel& model = *robot_with_cameras();
  Rig rig({}, world);
  Kinematics kinematics(robot_with_cameras());
  kinematics.place(rig.base, rig.q);
  const std::vector<DepthFrame> frames = rig.frames(0);
  ASSERT_EQ(frames.size(), model.sensors.size());
  std::map<int, int> ends;
  for (const DepthFrame& frame : frames) {
    EXPECT_EQ(frame.time, 0.0);
    const MountedSensor& mounted = model.sensors[static_cast<std::size_t>(frame.sensor)];
    const Isometry X_WC = kinematics.X_WL(mounted.link) * mounted.X_LC;
    const std::vector<Vector3> rays = RayView(mounted.sensor).directions_C();
    ASSERT_EQ(frame.ranges.size(), static_cast<Eigen::Index>(rays.size()));
    for (std::size_t i = 0; i < rays.size(); i += 7) {
      const Vector3 u = X_WC.linear() * rays[i], from = X_WC.translation();
      double wanted = u.z() < 0.0 ? -from.z() / u.z() : kInfinity;
      int end = wanted <= mounted.sensor.range ? 1 : 0;
      const auto meet = [&](const Shape& shape, const Isometry& X_WS, int what) {
        const double r = ray_distance(shape, X_WS.inverse() * from, X_WS.linear().transpose() * u);
        if (r < wanted) end = r <= mounted.sensor.range ? what : 0;
        wanted = std::min(wanted, r);
      };
      for (std::size_t o = 0; o < world.objects.size(); ++o) meet(world.objects[o].shape, rig.states[o].X_WO, 2);
      for (const CollisionShape& shape : model.shapes) meet(shape.shape, kinematics.X_WS(shape), 3);
      if (wanted > mounted.sensor.range) wanted = kInfinity;
      ++ends[end];
      const double found = frame.ranges[static_cast<Eigen::Index>(i)];
      if (wanted == kInfinity) {
        EXPECT_EQ(found, kInfinity);
      } else {
        EXPECT_NEAR(found, wanted, 1e-9);
      }
    }
  }
  for (const int end : {0, 1, 2, 3}) EXPECT_GT(ends[end], 20) << "nothing, floor, objects, robot: " << end;
}

TEST(DepthSensing, RangesHaveTheErrorsThatAreAskedFor) {
  Disturbances d;
  d.detection.ranges = {0.002, 0.003, 0.1};
  Rig exact, noisy(d), again(d);
  const std::vector<DepthFrame> right = exact.frames(0), wrong = noisy.frames(0);
  EXPECT_EQ(wrong[0].ranges, again.frames(0)[0].ranges) << "the same draws";
  double squares = 0.0, sum = 0.0;
  int measured = 0, missing = 0, all = 0;
  for (std::size_t s = 0; s < right.size(); ++s)
    for (Eigen::Index i = 0; i < right[s].ranges.size(); ++i) {
      ++all;
      const double r = right[s].ranges[i];
      if (wrong[s].ranges[i] == 0.0) {
        ++missing;
      } else if (std::isfinite(r)) {
        const double off = (wrong[s].ranges[i] - r) / (0.002 + 0.003 * r * r);
        squares += off * off;
        sum += off;
        ++measured;
      } else {
        EXPECT_EQ(wrong[s].ranges[i], r);
      }
    }
  EXPECT_NEAR(missing, 0.1 * all, 5.0 * std::sqrt(0.09 * all));
  ASSERT_GT(measured, 5000);
  EXPECT_NEAR(sum / measured, 0.0, 5.0 / std::sqrt(measured));
  EXPECT_NEAR(squares / measured, 1.0, 5.0 * std::sqrt(2.0 / measured));
}

TEST(DepthSensing, FramesArriveLateAndOnce) {
  Disturbances d;
  d.objects.delay = 0.08;
  Rig rig(d);
  EXPECT_EQ(rig.frames(0).size(), 6u) << "the first at once";
  std::vector<double> arrived;
  for (long k = 1; k < 40; ++k)
    for (const DepthFrame& frame : rig.frames(k)) {
      if (frame.sensor != 0) continue;
      EXPECT_NEAR(frame.time, static_cast<double>(k) * kStep - 0.08, 1e-9);
      arrived.push_back(frame.time);
    }
  ASSERT_EQ(arrived.size(), 7u) << "ten in a second";
  for (std::size_t i = 0; i < arrived.size(); ++i) EXPECT_NEAR(arrived[i], 0.1 * static_cast<double>(i + 1), 1e-9);
  d.objects.irregularity = {0.04, 0.3};
  Rig rough(d);
  int count = 0;
  for (long k = 1; k < 500; ++k)
    for (const DepthFrame& frame : rough.frames(k)) {
      if (frame.sensor == 0) ++count;
      EXPECT_GE(static_cast<double>(k) * kStep - frame.time, 0.08 - 1e-9);
      EXPECT_LE(static_cast<double>(k) * kStep - frame.time, 0.12 + 1e-9);
    }
  EXPECT_NEAR(count, 70, 20) << "of 100, less those that are lost";
}

ControllerParams with_map() {
  std::vector<std::string> warnings;
  return config::read_controller(config::load_yaml(source_path("configs/controllers/moma-map.yaml")), "controller",
                                 *robot_with_cameras(), kStep, warnings);
}

Observation seen_by(const Rig& rig, long k) {
  Observation o;
  o.time = static_cast<double>(k) * kStep;
  o.base = rig.base;
  o.q = rig.q;
  o.qdot = VectorX::Zero(robot_with_cameras()->num_velocities());
  o.goal.X_WG.translation() = Vector3(2.5, 1.0, 0.6);
  return o;
}

/// Distances of a map's box to the world's objects.
std::vector<double> gaps(const ObjectState& box, const World& world, const Rig& rig) {
  std::vector<double> out;
  for (std::size_t o = 0; o < world.objects.size(); ++o)
    out.push_back(
        shape_distance({ShapeKind::kBox, box.box, nullptr}, box.X_WO, world.objects[o].shape, rig.states[o].X_WO).d);
  return out;
}

TEST(SeenMap, BoxesAreWhereThingsStandAndNowhereElse) {
  const World world = room();
  Disturbances d;
  d.detection.ranges = {0.002, 0.0015, 0.02};
  Rig rig(d, world);
  MapParams params = with_map().map;
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  for (long k = 0; k < 60; ++k) {
    for (const DepthFrame& frame : rig.frames(k)) map.see(frame);
    map.observe(seen_by(rig, k));
  }
  EXPECT_FALSE(map.waits());
  EXPECT_EQ(map.left_out(), 0);
  Kinematics kinematics(robot_with_cameras());
  kinematics.place(rig.base, rig.q);
  std::vector<int> near(world.objects.size(), 0);
  int boxes = 0, unseen = 0;
  for (const ObjectState& state : map.states()) {
    if (!state.visible) continue;
    const Shape shape{ShapeKind::kBox, state.box, nullptr};
    for (const CollisionShape& own : robot_with_cameras()->shapes)
      EXPECT_GT(shape_distance(shape, state.X_WO, own.shape, kinematics.X_WS(own)).d, state.seen ? 0.0 : -0.02)
          << "the robot is not in its own way: " << own.name;
    if (!state.seen) {
      ++unseen;
      continue;
    }
    ++boxes;
    const std::vector<double> apart = gaps(state, world, rig);
    for (std::size_t o = 0; o < near.size(); ++o) near[o] += apart[o] <= 0.02 ? 1 : 0;
    EXPECT_LT(std::ranges::min(apart), 0.05) << "at " << state.X_WO.translation().transpose();
  }
  EXPECT_GT(boxes, 10);
  EXPECT_GT(unseen, 0) << "behind the arm, and beneath the base";
  for (std::size_t o = 0; o < near.size(); ++o) EXPECT_GT(near[o], 1) << world.objects[o].name;
}

TEST(SeenMap, AFrameCountsFromWhereTheRobotWas) {
  Disturbances d;
  d.objects.delay = 0.08;
  const World world = room();
  Rig rig(d, world);
  MapParams params = with_map().map;
  params.unseen.enabled = false;
  // The base's measurements are as late as 40 ms.
  SeenMap map(robot_with_cameras(), params, 0.04, 0.0);
  const auto base_at = [](long k) {
    return Vector3(0.01 * static_cast<double>(std::max(0L, k)), 0.0, 0.02 * static_cast<double>(std::max(0L, k)));
  };
  for (long k = 0; k < 40; ++k) {
    rig.base = base_at(k);
    for (const DepthFrame& frame : rig.frames(k)) map.see(frame);
    Observation o = seen_by(rig, k);
    o.base = base_at(k - 2);
    map.observe(o);
  }
  int boxes = 0;
  for (const ObjectState& state : map.states()) {
    if (!state.visible) continue;
    ++boxes;
    EXPECT_LT(std::ranges::min(gaps(state, world, rig)), 0.06) << "at " << state.X_WO.translation().transpose();
  }
  EXPECT_GT(boxes, 10);
}

// A narrow camera that looks between two objects sees both on a head that looks at what is unseen.
TEST(SeenMap, AHeadLooksToItsSides) {
  const World world = room();
  for (const double reach : {0.0, 1.1}) {
    auto model = std::make_shared<RobotModel>(*robot_with_cameras());
    MountedSensor& camera = model->sensors[0];
    model->sensors.resize(1);
    camera.sensor.field_of_view = {0.4, 0.6};
    camera.sensor.head = {
        .axes = {0.1, 0.0, 0.9}, .pan = {-reach, reach}, .tilt = {-0.3 * reach, 0.3 * reach}, .speed = 3.0};
    camera.X_LC.linear() = Eigen::AngleAxisd(0.9, Vector3::UnitZ()) * camera.X_LC.linear();
    Rig rig({}, world, model);
    SeenMap map(model, with_map().map, 0.0, 0.0);
    Gaze least, most, last;
    for (long k = 0; k < 400; ++k) {
      for (const DepthFrame& frame : rig.frames(k, map.gaze(0))) {
        least = {std::min(least.pan, frame.gaze.pan), std::min(least.tilt, frame.gaze.tilt)};
        most = {std::max(most.pan, frame.gaze.pan), std::max(most.tilt, frame.gaze.tilt)};
        EXPECT_LE(std::abs(frame.gaze.pan - last.pan), 3.0 * 0.1 + 1e-9) << "frames are 0.1 s apart";
        last = frame.gaze;
        map.see(frame);
      }
      map.observe(seen_by(rig, k));
    }
    EXPECT_NEAR(most.pan, reach, 1e-9);
    EXPECT_NEAR(least.pan, -reach, 1e-9);
    EXPECT_NEAR(most.tilt, 0.3 * reach, 1e-9);
    EXPECT_NEAR(least.tilt, -0.3 * reach, 1e-9);
    std::vector<int> near(world.objects.size(), 0);
    for (const ObjectState& state : map.states()) {
      if (!state.visible || !state.seen) continue;
      const std::vector<double> d = gaps(state, world, rig);
      for (std::size_t o = 0; o < near.size(); ++o) near[o] += d[o] <= 0.02 ? 1 : 0;
      EXPECT_LT(std::ranges::min(d), 0.05) << "at " << state.X_WO.translation().transpose();
    }
    EXPECT_EQ(near[0] > 1, reach > 0.0) << "the box, 0.8 rad to the right";
    EXPECT_EQ(near[1] > 1, reach > 0.0) << "the ball, 1.1 rad to the left";
  }
}

// The head of a camera that looks ahead turns far enough to see behind the base, or does not.
TEST(LooksBehind, WhereACameraOrItsHeadCanSee) {
  RobotModel model = *robot_with_cameras();
  EXPECT_TRUE(looks_behind(model)) << "a ring of cameras";
  const MountedSensor front = model.sensors[0];
  std::erase_if(model.sensors, [](const MountedSensor& mounted) { return mounted.sensor.rows > 1; });
  ASSERT_EQ(model.sensors.size(), 2U);
  EXPECT_FALSE(looks_behind(model)) << "planes at 0.2 m";
  model.sensors = {front};
  EXPECT_FALSE(looks_behind(model));
  for (const double pan : {1.0, 2.6}) {
    model.sensors[0].sensor.head = {.pan = {-pan, pan}, .tilt = {-0.5, 0.5}};
    EXPECT_EQ(looks_behind(model), pan > 2.0) << pan << " and half a field of view of 0.79 rad, 0.7 rad down";
  }
}

MountedSensor narrow_camera_on_a_head() {
  MountedSensor camera = robot_with_cameras()->sensors[0];
  camera.X_LC = Isometry::Identity();
  camera.sensor.field_of_view = {0.4, 0.4};
  camera.sensor.head = {.pan = {-1.5, 1.5}, .tilt = {-0.5, 0.5}};
  return camera;
}

// A head looks first at what is worth most, then at everything else, since what an arm hides stays unseen.
TEST(GazeChoice, WhatIsWorthMostComesFirstAndNothingIsLeftOut) {
  const MountedSensor camera = narrow_camera_on_a_head();
  GazeChoice choice(camera);
  ASSERT_TRUE(choice.on());
  Isometry X_WL = Isometry::Identity();
  X_WL.translation() = Vector3(0.0, 0.0, 1.0);
  const std::vector<Sight> sights{
      {Vector3(1.0, 1.0, 1.0), 50.0}, {Vector3(1.0, -1.0, 1.0), 20.0}, {Vector3(-1.0, 0.0, 1.0), 1000.0}};
  std::vector<std::pair<double, double>> looked;
  int first = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const Gaze before = choice.wanted();
    choice.saw({before.pan, 3.0}, 0.1 * frame, X_WL, sights);
    EXPECT_EQ(choice.wanted(), before) << "the head was on its way";
    choice.saw(before, 0.1 * frame + 0.05, X_WL, sights);
    const Vector3 along = camera.turned(choice.wanted()).linear().col(0);
    const bool left = along.dot(Vector3(1, 1, 0).normalized()) > 0.9;
    if (frame == 0) {
      EXPECT_TRUE(left) << along.transpose();
    }
    first += left ? 1 : 0;
    looked.emplace_back(choice.wanted().pan, choice.wanted().tilt);
  }
  EXPECT_GT(first, 100);
  std::ranges::sort(looked);
  const auto repeated = std::ranges::unique(looked);
  EXPECT_EQ(looked.size() - repeated.size(), 16U * 6U) << "views 0.2 rad apart";
}

// A head that does not come to where it should look is sent elsewhere.
TEST(GazeChoice, AHeadThatIsStuckIsSentElsewhere) {
  const MountedSensor camera = narrow_camera_on_a_head();
  GazeChoice choice(camera);
  const std::vector<Sight> sights{{Vector3(0.1, 1.0, 0.0), 50.0}};
  constexpr double kStop = 0.8;  // the head turns no further
  std::set<std::pair<double, double>> wanted;
  int beyond = 0;
  for (int frame = 0; frame < 600; ++frame) {
    const Gaze look = choice.wanted();
    choice.saw({std::clamp(look.pan, -kStop, kStop), look.tilt}, 0.1 * frame, Isometry::Identity(), sights);
    wanted.emplace(choice.wanted().pan, choice.wanted().tilt);
    beyond += std::abs(choice.wanted().pan) > kStop ? 1 : 0;
  }
  EXPECT_GT(beyond, 50) << "the sight is beyond the stop";
  EXPECT_GT(wanted.size(), 20U);
}

TEST(SeenMap, WhatGoesIsForgottenAndWhatIsHiddenIsKept) {
  Rig rig;
  MapParams params = with_map().map;
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  const auto occupied_near = [&](const Vector3& p) {
    return std::any_of(map.states().begin(), map.states().end(), [&](const ObjectState& state) {
      return state.visible && state.seen && (state.X_WO.translation() - p).cwiseAbs().maxCoeff() < 0.4;
    });
  };
  const auto go_on = [&](long from, long to) {
    for (long k = from; k < to; ++k) {
      for (const DepthFrame& frame : rig.frames(k)) map.see(frame);
      map.observe(seen_by(rig, k));
    }
  };
  go_on(0, 50);
  EXPECT_TRUE(occupied_near({1.25, 0.2, 0.5}));
  EXPECT_TRUE(occupied_near({-0.5, 1.2, 0.6}));
  rig.states[1].visible = false;  // the ball is taken away
  go_on(50, 150);
  EXPECT_TRUE(occupied_near({1.25, 0.2, 0.5}));
  EXPECT_FALSE(occupied_near({-0.5, 1.2, 0.6}));
  rig.states[0].visible = false;  // and the box, while no sensor works
  for (long k = 150; k < 250; ++k) map.observe(seen_by(rig, k));
  EXPECT_TRUE(occupied_near({1.25, 0.2, 0.5})) << "out of view is not gone";
}

TEST(SeenMap, AStepTakesNoMoreFramesThanItHasRaysFor) {
  Rig rig;
  MapParams params = with_map().map;
  params.rays = 4000;  // one camera's frame and no other
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  for (const DepthFrame& frame : rig.frames(0)) map.see(frame);
  int steps = 0;
  for (; steps < 20 && (steps == 0 || map.waits()); ++steps) map.observe(seen_by(rig, steps));
  EXPECT_EQ(steps, 5) << "four cameras, and two scanners in one step";
}

// Distances from cells' middles by the distance library.
double gap_to_robot(const Rig& rig, const Vector3& p) {
  Kinematics kinematics(robot_with_cameras());
  kinematics.place(rig.base, rig.q);
  Isometry X_WP = Isometry::Identity();
  X_WP.translation() = p;
  double least = kInfinity;
  for (const CollisionShape& own : robot_with_cameras()->shapes)
    least = std::min(
        least, shape_distance({ShapeKind::kSphere, {1e-3, 0, 0}, nullptr}, X_WP, own.shape, kinematics.X_WS(own)).d);
  return least;
}

// A robot that comes near takes nothing out of the map but the cells that it fills on its way.
TEST(SeenMap, ComingNearToSomethingDoesNotRemoveIt) {
  Rig rig;
  MapParams params = with_map().map;
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  for (long k = 0; k < 20; ++k) {
    for (const DepthFrame& frame : rig.frames(k)) map.see(frame);
    map.observe(seen_by(rig, k));
  }
  const OccupancyMap& cells = map.map();
  const Vector3 half = Vector3::Constant(0.5 * cells.cell());
  const OccupancyMap before = cells;
  const auto least_to_box = [&] {
    Kinematics kinematics(robot_with_cameras());
    kinematics.place(rig.base, rig.q);
    double least = kInfinity;
    for (const CollisionShape& own : robot_with_cameras()->shapes)
      least = std::min(least,
                       shape_distance(own.shape, kinematics.X_WS(own), room().objects[0].shape, rig.states[0].X_WO).d);
    return least;
  };
  // Frames are empty while it moves up to 1.5 cm before the box.
  for (long k = 20; least_to_box() > 0.015; ++k) {
    rig.base.x() += 0.01;
    DepthFrame nothing = rig.frames(0).front();
    nothing.ranges.setZero();
    nothing.time = static_cast<double>(k) * kStep;
    map.see(nothing);
    map.observe(seen_by(rig, k));
  }
  int occupied = 0, unseen = 0;
  Eigen::Vector3i c;
  for (c.x() = 0; c.x() < before.cells().x(); ++c.x())
    for (c.y() = 0; c.y() < before.cells().y(); ++c.y())
      for (c.z() = 0; c.z() < before.cells().z(); ++c.z()) {
        if (!before.occupied(c) && !before.unseen(c)) continue;
        const Vector3 middle = before.low_corner(c) + half;
        if ((middle - rig.base).head<2>().norm() > 1.2) continue;
        if (before.odds(c) == cells.odds(c + before.origin() - cells.origin())) continue;
        double gap = kInfinity;
        for (Rig there; there.base.x() <= rig.base.x(); there.base.x() += 0.01)
          gap = std::min(gap, gap_to_robot(there, middle));
        if (gap > 0.005) ++(before.occupied(c) ? occupied : unseen);
      }
  EXPECT_EQ(occupied, 0) << "cells of what it saw";
  EXPECT_EQ(unseen, 0) << "cells that nobody has seen";
}

// The first frames, without a range.
void see_nothing(SeenMap& map, Rig& rig) {
  for (DepthFrame frame : rig.frames(0)) {
    frame.ranges.setZero();
    map.see(frame);
  }
  map.observe(seen_by(rig, 0));
}

// Before any ray: free is what is as near to the robot as it believes, and the space beside and above its base.
TEST(SeenMap, AtTheStartLittleCountsAsFree) {
  Rig rig;
  const MapParams params = with_map().map;
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  see_nothing(map, rig);
  const OccupancyMap& cells = map.map();
  const double whole = params.unseen.start - 0.5 * std::sqrt(3.0) * cells.cell();  // no corner is farther away
  int free = 0, far = 0, missed = 0;
  Eigen::Vector3i c;
  for (c.x() = 0; c.x() < cells.cells().x(); ++c.x())
    for (c.y() = 0; c.y() < cells.cells().y(); ++c.y())
      for (c.z() = 0; c.z() < cells.cells().z(); ++c.z()) {
        const Vector3 middle = cells.low_corner(c) + Vector3::Constant(0.5 * cells.cell());
        if ((middle - rig.base).head<2>().norm() > 1.3) continue;
        const bool beside = std::abs(middle.x()) < 0.55 && std::abs(middle.y()) < 0.45;
        if (beside && cells.unseen(c)) continue;
        const double gap = gap_to_robot(rig, middle);
        if (!cells.unseen(c)) {
          ++free;
          far += gap > whole && !beside ? 1 : 0;
        } else {
          missed += gap < whole - 0.002 ? 1 : 0;
        }
      }
  EXPECT_GT(free, 1000);
  EXPECT_EQ(far, 0);
  EXPECT_EQ(missed, 0);
}

// Of many unseen cells those at the hand become boxes, wherever the arm is stretched to.
TEST(SeenMap, UnseenSpaceIsNearestToTheArmFirst) {
  Rig rig;
  rig.q << 0.0, 1.2, 0.0, -0.6, 0.0, 1.8, 0.8;  // stretched ahead
  const MapParams params = with_map().map;
  SeenMap map(robot_with_cameras(), params, 0.0, 0.0);
  see_nothing(map, rig);
  Kinematics kinematics(robot_with_cameras());
  kinematics.place(rig.base, rig.q);
  for (const CollisionShape& own : robot_with_cameras()->shapes) {
    if (own.rigid_with_base) continue;
    double least = kInfinity;
    for (const ObjectState& state : map.states()) {
      if (!state.visible || state.seen) continue;
      least = std::min(
          least, shape_distance(own.shape, kinematics.X_WS(own), {ShapeKind::kBox, state.box, nullptr}, state.X_WO).d);
    }
    const Vector3 p = kinematics.X_WS(own).translation();
    if ((p - rig.base).head<2>().norm() < 0.65) continue;  // above the base all is free
    EXPECT_LT(least, params.unseen.start + 0.03) << own.name;
  }
}

// The whole controller, with frames, unseen space, rows, check, plans.
TEST(SeenMap, AStepOfTheControllerTakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Disturbances d;
  d.objects.delay = 0.08;
  Rig rig(d);
  ControllerCore controller(robot_with_cameras(), with_map(), kStep);
  controller.reset({});
  StepResult result;
  controller.prepare(result);
  std::vector<std::vector<DepthFrame>> frames;
  for (long k = 0; k < 80; ++k) frames.push_back(rig.frames(k));
  int rows = 0;
  const NoAlloc guard;
  for (long k = 0; k < 80; ++k) {
    for (const DepthFrame& frame : frames[static_cast<std::size_t>(k)]) controller.see(frame);
    const Observation o = seen_by(rig, k);
    const int before = guard.count();
    controller.step(o, result);
    ASSERT_EQ(guard.count(), before) << "step " << k;
    rows += result.rows;
  }
  EXPECT_GT(rows, 100);
  EXPECT_GT(controller.object_names().size(), 300u);
}

}  // namespace
}  // namespace moma::test
