// The look-ahead among moving objects: it plans, and keeps room on its path.
#include <gtest/gtest.h>

#include "tests/controller/lookahead_loop.h"

namespace moma::test {
namespace {

class AheadInTraffic : public Ahead {};

INSTANTIATE_TEST_SUITE_P(Robots, AheadInTraffic, testing::ValuesIn(lookahead_robots()),
                         [](const auto& param) { return test_name(param.param); });

// Somebody who walks by at a distance does not keep the robot behind the wall.
TEST_P(AheadInTraffic, PlansWhileSomethingMoves) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  Scene scene = behind_a_wall(model, 1);
  scene.shapes.push_back({"walker", make_box(0.3, 0.3, 1.6)});
  ObjectState state;
  state.X_WO.translation() = Vector3(-2.0, -2.0, 0.8);
  state.V_WO_W[3] = -0.2;
  scene.states.push_back(state);
  Loop loop(model, read_params(*model, true), scene);
  const PlanState& plan = loop.controller.lookahead()->state();
  bool followed = false;
  for (int i = 0; i < 200 && !followed; ++i) {
    loop.step();
    followed = plan.brief.mode == PlanMode::kFollow;
  }
  EXPECT_TRUE(followed) << "mode " << static_cast<int>(plan.brief.mode) << ", reason "
                        << static_cast<int>(plan.brief.reason);
}

// An object crosses the way and will be in its middle once the base gets there. Standing where it is now, it is in
// nobody's way.
TEST_P(AheadInTraffic, WaysKeepClearOfWhereAnObjectWillBe) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const ControllerParams params = read_params(*model, true);
  Scene scene = make_scene(model, 1, 0);
  const Vector2 from = scene.start.head<2>(), middle = 0.5 * (from + scene.X_WG.translation().head<2>());
  const Vector2 along = (middle - from).normalized(), across(-along.y(), along.x());
  constexpr double kSpeed = 0.3;
  Vector2 now = middle;
  for (int i = 0; i < 50; ++i)
    now = middle - kSpeed * (now - from).norm() / (params.plan.decisions.meet_speed * model->base.max_linear) * across;
  scene.shapes = {{"pillar", make_box(0.2, 0.2, 1.5)}};
  scene.states.assign(1, ObjectState{});
  const auto way = [&](double speed) {
    scene.states[0].X_WO.translation() << now, 0.75;
    scene.states[0].V_WO_W << Vector3::Zero(), speed * across, 0.0;
    Choice choice(model, params);
    choice.reset(scene.shapes);
    choice.begin(Loop(model, params, scene).o, -1.0, 1);
    long budget = 1'000'000;
    while (choice.advance(budget)) {
    }
    EXPECT_EQ(choice.verdict().kind, PlanKind::kPath);
    return choice.path();
  };
  const auto least_in_the_middle = [&](const Path& path) {
    scene.states[0].X_WO.translation() << middle, 0.75;
    scene.states[0].V_WO_W.setZero();
    Kinematics kinematics(model);
    WholeConfiguration c;
    double least = kInfinity;
    for (double t = 0.0; t <= path.duration; t += 0.05) {
      path.at(t, c);
      kinematics.update(c.head<3>(), c.tail(model->num_joints()));
      least = std::min(least, object_clearance(*model, kinematics, scene));
    }
    return least;
  };
  EXPECT_LT(least_in_the_middle(way(0.0)), 0.0) << "the pillar's place is not on the way";
  EXPECT_GT(least_in_the_middle(way(kSpeed)), 0.5 * params.plan.clearance);
}

// A ball that turns in its place 3 cm beyond the clearance of the path holds back the path's clock.
TEST_P(AheadInTraffic, KeepsMoreThanThePathsClearanceFromWhatMoves) {
  for (const double room : {0.0, 0.05}) {
    Scene scene = make_scene(model, 1, 0);
    scene.shapes.push_back({"ball", make_sphere(0.05)});
    scene.states.resize(1);
    scene.states[0].X_WO.translation() << 20.0, 0.0, 1.0;
    scene.states[0].V_WO_W[2] = 0.5;
    ControllerParams params = read_params(*model, true);
    params.plan.decisions.meet_room = room;
    Loop loop(model, params, scene);
    const PlanBrief& brief = loop.controller.lookahead()->state().brief;
    for (int i = 0; i < 100 && brief.clock < 0.1; ++i) loop.step();
    ASSERT_EQ(brief.mode, PlanMode::kFollow);
    const Path& path = loop.controller.lookahead()->state().path;
    // Above the hand at the path's end, as high as leaves that distance on all of the way.
    Kinematics kinematics(model);
    const auto least = [&](double height) {
      scene.states[0].X_WO.translation() = scene.X_WG.translation() + height * Vector3::UnitZ();
      double found = 1e9;
      WholeConfiguration at;
      for (double t = brief.clock; t < path.duration + 0.02; t += 0.02) {
        path.at(std::min(t, path.duration), at);
        kinematics.update(at.head<3>(), at.tail(model->num_joints()));
        found = std::min(found, object_clearance(*model, kinematics, scene));
      }
      return found;
    };
    double low = 0.0, high = 1.5;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (least(middle) < path.clearance + 0.03 ? low : high) = middle;
    }
    ASSERT_NEAR(least(high), path.clearance + 0.03, 1e-3);
    while (path.duration - brief.clock > 1.2) loop.step();
    loop.o.objects = scene.states;
    const double before = brief.clock;
    loop.step();
    const double rate = (brief.clock - before) / kPeriod;
    if (room > 0.0)
      EXPECT_LT(rate, 0.7);
    else
      EXPECT_GT(rate, 0.9);
  }
}

}  // namespace
}  // namespace moma::test
