// Rollouts against a plant of its own, choices against what they lead to, and what a step may cost and depend on.
#include "controller/lookahead/lookahead.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "controller/lookahead/choice.h"
#include "tests/controller/lookahead_loop.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

INSTANTIATE_TEST_SUITE_P(Robots, Ahead, testing::ValuesIn(lookahead_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(Ahead, ARolloutIsWhatTheRobotDoes) {
  int arrived = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = make_scene(model, seed, 8);
    const ControllerParams params = read_params(*model, false);
    Loop loop(model, params, scene);
    Rollout rollout(model, params, kPeriod);
    rollout.reset(scene.shapes);
    rollout.begin(loop.o, EscapeState{}, {.time = 8.0, .touch = 0.0, .stagnation_ends = false});
    RolloutEnd end = RolloutEnd::kGoesOn;
    while (end == RolloutEnd::kGoesOn && !rollout.over()) {
      end = rollout.step();
      if (end != RolloutEnd::kGoesOn) break;
      loop.step();
      ASSERT_EQ((rollout.state().base - loop.o.base).norm(), 0.0) << "at " << loop.o.time;
      ASSERT_EQ((rollout.state().q - loop.o.q).norm(), 0.0) << "at " << loop.o.time;
    }
    if (end != RolloutEnd::kArrives) continue;
    ++arrived;
    EXPECT_TRUE(loop.there());
    EXPECT_NEAR(rollout.time(), loop.o.time, 1e-9);
  }
  EXPECT_GT(arrived, 0) << "no rollout arrived: its end was never tried";
}

TEST_P(Ahead, ARolloutSaysWhyItStops) {
  const Scene empty = make_scene(model, 2, 0);
  const ControllerParams params = read_params(*model, false);
  Rollout rollout(model, params, 0.04);
  Observation o = Loop(model, params, empty).o;
  const auto run = [&](const RolloutLimits& limits) {
    rollout.begin(o, EscapeState{}, limits);
    while (!rollout.over())
      if (rollout.step() != RolloutEnd::kGoesOn) break;
    return rollout.end();
  };
  rollout.reset({});
  EXPECT_EQ(run({.time = 0.2}), RolloutEnd::kGoesOn);
  EXPECT_NEAR(rollout.time(), 0.2, 0.021);
  // Within reach of nothing: the goal is 3 m up.
  o.goal.X_WG.translation().z() = 3.0;
  EXPECT_EQ(run({.time = 20.0}), RolloutEnd::kStagnates);
  // Something falls on the robot, too wide and too fast to get out of its way.
  const std::vector<ObjectShape> ball{{"ball", make_sphere(0.8)}};
  rollout.reset(ball);
  o.objects.resize(1);
  Kinematics kinematics(model);
  kinematics.update(o.base, o.q);
  o.objects[0].X_WO.translation() = kinematics.X_WE().translation() + Vector3(0.0, 0.0, 2.0);
  o.objects[0].V_WO_W[5] = -8.0;
  EXPECT_EQ(run({.time = 20.0}), RolloutEnd::kTouches);
  EXPECT_LT(rollout.time(), 1.0);
}

TEST_P(Ahead, GetsRoundAWallThatThePolicyDoesNot) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  int with = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = behind_a_wall(model, seed);
    double least = 0.0;
    Loop plain(model, read_params(*model, false), scene);
    without += plain.run(20.0, least) >= 0.0 ? 1 : 0;
    Loop ahead(model, read_params(*model, true), scene);
    const double time = ahead.run(20.0, least);
    EXPECT_GE(time, 0.0) << "seed " << seed;
    EXPECT_GT(least, 0.0) << "seed " << seed;
    with += time >= 0.0 ? 1 : 0;
    EXPECT_GT(ahead.controller.lookahead()->state().brief.attempts, 0);
  }
  EXPECT_GE(with, without);
}

// The path leads to where the goal is expected; the policy takes over where it is predicted to arrive.
TEST_P(Ahead, GetsRoundAWallToAGoalInMotion) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  int met = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Loop loop(model, read_params(*model, true), behind_a_wall(model, seed));
    loop.o.goal.V_WG_W[4] = 0.1;
    double least = kInfinity;
    const PlanState& state = loop.controller.lookahead()->state();
    while (loop.o.time < 20.0 && !loop.there()) {
      loop.step();
      least = std::min(least, loop.clearance());
      met += state.brief.mode == PlanMode::kFollow && state.path.meets ? 1 : 0;
    }
    EXPECT_LT(loop.o.time, 20.0) << "seed " << seed;
    EXPECT_GT(least, 0.0) << "seed " << seed;
  }
  EXPECT_GT(met, 0);
}

TEST_P(Ahead, OffIsAsIfItWereNotThere) {
  const Scene scene = make_scene(model, 3, 10);
  ControllerParams off = read_params(*model, false);
  off.plan.budget = 7;
  Loop a(model, read_params(*model, false), scene), b(model, off, scene);
  for (int i = 0; i < 150; ++i) {
    a.step();
    b.step();
    ASSERT_EQ((a.result.command - b.result.command).norm(), 0.0) << "step " << i;
  }
  EXPECT_EQ(a.controller.lookahead(), nullptr);
}

TEST_P(Ahead, TheSameInputsGiveTheSameBits) {
  const Scene scene = make_scene(model, 5, 20);
  const ControllerParams params = read_params(*model, true);
  Loop a(model, params, scene), b(model, params, scene);
  for (int i = 0; i < 400; ++i) {
    a.step();
    b.step();
    ASSERT_EQ((a.result.command - b.result.command).norm(), 0.0) << "step " << i;
  }
}

// A gap in which the rows' own stop distance lets no base drive: on a path they keep what the path keeps.
TEST(AheadOfAGap, RowsLetAPathThrough) {
  const auto model = load_model("configs/robots/frankie.yaml");
  const ControllerParams params = read_params(*model, true, "moma");
  const double tight = params.plan.search.tight * params.plan.clearance, margin = 1.3 * tight;
  ASSERT_LT(margin, params.collision.object.stop);
  Loop loop(model, params, before_a_gap(model, 1, margin));
  double least = 0.0;
  EXPECT_GT(loop.run(20.0, least), 0.0) << "it stands " << loop.clearance() << " m from the wall";
  EXPECT_GT(least, 0.9 * tight);
}

// Braking before the sides of a gap would lead the robot off its path and take time: the path does not hit them.
TEST(AheadOfAGap, FollowsAPathPastWhatItCouldNotStopAt) {
  const auto model = load_model("configs/robots/frankie.yaml");
  int follows = 0, aside = 0;
  double time = 0.0;
  for (const double margin : {0.03, 0.05, 0.07, 0.09}) {
    Loop loop(model, read_params(*model, true, "moma"), before_a_gap(model, 1, margin));
    const Lookahead& ahead = *loop.controller.lookahead();
    while (loop.o.time < 20.0 && !loop.there()) {
      loop.step();
      if (ahead.state().brief.mode != PlanMode::kFollow) continue;
      ++follows;
      aside += (loop.result.command - ahead.velocities()).lpNorm<Eigen::Infinity>() > 0.1 ? 1 : 0;
    }
    EXPECT_LT(loop.o.time, 20.0) << margin;
    time += loop.o.time;
  }
  std::printf("%d of %d steps along paths are not as these ask; %.2f s\n", aside, follows, time);
  EXPECT_GT(follows, 300);
  EXPECT_LT(aside, 0.12 * follows);
  EXPECT_LT(time, 12.2);  // 12.9 s where rows brake
}

// A robot that was pushed off its path may hit what the path passes: its rows brake again.
TEST(AheadOfAGap, PassesNothingBesideItsPath) {
  const auto model = load_model("configs/robots/frankie.yaml");
  const ControllerParams params = read_params(*model, true, "moma");
  Loop loop(model, params, before_a_gap(model, 1, 0.09));
  const Lookahead& ahead = *loop.controller.lookahead();
  EXPECT_FALSE(ahead.passes()) << "without a path";
  while (loop.o.time < 20.0 && !(ahead.state().brief.mode == PlanMode::kFollow && loop.o.base.x() > 0.3)) loop.step();
  ASSERT_LT(loop.o.time, 20.0);
  ASSERT_FALSE(ahead.state().path.close());
  const double spare = (1.0 - params.plan.follow.kept) * ahead.state().path.clearance;
  EXPECT_LT(ahead.state().brief.lag, spare);
  EXPECT_TRUE(ahead.passes());
  loop.o.base.y() += 0.1;
  loop.step();
  EXPECT_GT(ahead.state().brief.lag, spare);
  EXPECT_FALSE(ahead.passes());
}

// While a choice is worked out the robot does what the policy alone would do, bit for bit, and does not stand.
TEST_P(Ahead, GoesOnWhileItChooses) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  int going_on = 0, chosen = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = behind_a_wall(model, seed);
    ControllerParams params = read_params(*model, true);
    params.plan.budget = 2000;
    params.plan.direct = 0;
    Loop ahead(model, params, scene), plain(model, read_params(*model, false), scene);
    const PlanState& state = ahead.controller.lookahead()->state();
    for (int i = 0; i < 60; ++i) {
      const GoingOn* now = std::get_if<GoingOn>(&state.doing);
      const bool goes_on = now != nullptr && state.steps < now->commit;
      const bool direct = goes_on || std::holds_alternative<GoingDirect>(state.doing);
      ahead.step();
      plain.step();
      if (!direct || state.brief.attempts > 1) break;
      going_on += goes_on ? 1 : 0;
      ASSERT_EQ((ahead.result.command - plain.result.command).norm(), 0.0) << "seed " << seed << " step " << i;
    }
    // What was chosen takes effect where the robot is: a path begins where it would come to rest.
    if (state.brief.mode != PlanMode::kFollow) continue;
    ++chosen;
    WholeConfiguration stand = state.path.origin;
    EXPECT_LT((stand.head<2>() - ahead.o.base.head<2>()).norm(), 0.3) << "seed " << seed;
    EXPECT_LT(state.brief.lag, 0.3) << "seed " << seed;
  }
  EXPECT_GT(going_on, 10);
  EXPECT_GT(chosen, 0);
}

// A choice is the same however it is spread, and it falls on the quicker of policy and path.
// Of joints alone the place of rest has a closed form.
TEST(Rest, JointsComeToRestWhereConstantDecelerationTakesThem) {
  const auto model = load_model("configs/robots/panda.yaml");
  const MotionLimits limits(*model, plan_params(*model));
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  for (Eigen::Index i = 0; i < o.qdot.size(); ++i) o.qdot[i] = (i % 2 == 0 ? 0.3 : -0.2) * static_cast<double>(i);
  const VectorX times = o.qdot.cwiseAbs().cwiseQuotient(limits.joint_acceleration);
  WholeConfiguration each, evenly;
  EXPECT_DOUBLE_EQ(comes_to_rest(*model, limits, o, Rest::kEach, each), times.maxCoeff());
  EXPECT_DOUBLE_EQ(comes_to_rest(*model, limits, o, Rest::kEvenly, evenly), times.maxCoeff());
  constexpr double kMoments = 2e-3;  // error of the steps in which rest is computed [rad]
  for (Eigen::Index i = 0; i < o.qdot.size(); ++i) {
    EXPECT_NEAR(each[3 + i], o.q[i] + 0.5 * o.qdot[i] * times[i], kMoments) << i;
    EXPECT_NEAR(evenly[3 + i], o.q[i] + 0.5 * o.qdot[i] * times.maxCoeff(), 1e-9) << i;
  }
}

TEST_P(Ahead, AChoiceDoesNotDependOnTheBudget) {
  const Scene scene = !model->mobile() ? make_scene(model, 1, 12) : behind_a_wall(model, 3);
  const ControllerParams params = read_params(*model, true);
  Choice choice(model, params);
  const Observation o = Loop(model, params, scene).o;
  const auto choose = [&](double direct_time, long per_step) {
    choice.reset(scene.shapes);  // which forgets what the planner found before
    choice.begin(o, direct_time, 1);
    bool more = true;
    for (int k = 0; more && k < 1000000; ++k) {
      long budget = per_step;
      more = choice.advance(budget);
    }
    EXPECT_FALSE(more);
    return choice.verdict();
  };
  const PlanVerdict whole = choose(-1.0, 1L << 30);
  EXPECT_EQ(whole.kind, PlanKind::kPath);
  EXPECT_EQ(whole.tried, 2);
  EXPECT_GE(whole.by_path, 0.0);
  for (const long per_step : {300L, 7L}) {
    const PlanVerdict spread = choose(-1.0, per_step);
    EXPECT_EQ(spread.kind, whole.kind);
    EXPECT_EQ(spread.by_path, whole.by_path);
  }
  EXPECT_EQ(choose(whole.by_path + 1.0, 300L).kind, PlanKind::kPath);
  const PlanVerdict quick = choose(0.1, 300L);
  EXPECT_EQ(quick.kind, PlanKind::kPolicy);
  EXPECT_LT(quick.by_path, 0.0);
}

// A robot that stands where nothing arrives looks for a path with more and more work; one that arrives or drives does
// not.
TEST_P(Ahead, AChoiceWithoutAWayOutPlansAgain) {
  Scene scene = make_scene(model, 1, 0);
  scene.X_WG.translation().z() += 5.0;  // out of reach
  ControllerParams params = read_params(*model, true);
  Choice choice(model, params);
  Observation o = Loop(model, params, scene).o;
  const auto work = [&](double direct_time) {
    choice.reset(scene.shapes);
    choice.begin(o, direct_time, 1);
    constexpr long kPlenty = 1L << 40;
    long budget = kPlenty;
    EXPECT_FALSE(choice.advance(budget));
    EXPECT_EQ(choice.verdict().kind, PlanKind::kPolicy);
    return kPlenty - budget;
  };
  const long again = work(-1.0), once = work(100.0);
  EXPECT_GT(again, 2 * once);
  o.qdot[0] = 0.3;
  EXPECT_LT(work(-1.0), 1.5 * once);
}

// Ways lead around space that no sensor has seen; where it is all round, they lead through it.
TEST_P(Ahead, LeadsAroundWhatNobodyHasSeen) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const auto choose = [&](const std::vector<std::pair<Vector3, Vector3>>& boxes, std::vector<ObjectState>& states) {
    Scene scene = behind_a_wall(model, 2);
    for (const auto& [size, middle] : boxes) {
      scene.shapes.push_back({"unseen", {ShapeKind::kBox, size, nullptr}});
      ObjectState& state = scene.states.emplace_back();
      state.X_WO.translation() = middle;
      state.box = size;
      state.seen = false;
    }
    states = scene.states;
    const ControllerParams params = read_params(*model, true);
    Choice choice(model, params);
    choice.reset(scene.shapes);
    choice.begin(Loop(model, params, scene).o, -1.0, 1);
    long budget = 1L << 30;
    EXPECT_FALSE(choice.advance(budget));
    EXPECT_EQ(choice.verdict().kind, PlanKind::kPath);
    return choice.path();
  };
  // How deep the path leads into it.
  const auto deepest = [&](const Path& path, const std::vector<ObjectState>& states) {
    Kinematics kinematics(model);
    WholeConfiguration c;
    double least = 0.0;
    for (double t = 0.0; t <= path.duration; t += 0.02) {
      path.at(t, c);
      kinematics.update(c.head<3>(), c.tail(model->num_joints()));
      for (const ObjectState& state : states)
        if (!state.seen)
          for (const CollisionShape& shape : model->shapes)
            least = std::min(least, shape_distance(shape.shape, kinematics.X_WS(shape),
                                                   {ShapeKind::kBox, state.box, nullptr}, state.X_WO)
                                        .d);
    }
    return -least;
  };
  std::vector<ObjectState> states;
  WholeConfiguration middle;
  const Path direct = choose({}, states);
  direct.at(0.5 * direct.duration, middle);
  const std::pair<Vector3, Vector3> there{{0.3, 0.3, 1.0}, {middle.x(), middle.y(), 0.5}};
  const double through = [&] {
    std::vector<ObjectState> box(1);
    box[0].X_WO.translation() = there.second;
    box[0].box = there.first;
    box[0].seen = false;
    return deepest(direct, box);
  }();
  ASSERT_GT(through, 0.1);
  const Path around = choose({there}, states);
  EXPECT_LT(deepest(around, states), 0.012) << "map.unseen.around, and what lies between two checks";
  const Path out = choose({{{9.0, 0.3, 2.0}, {0.0, 1.5, 1.0}},
                           {{9.0, 0.3, 2.0}, {0.0, -1.5, 1.0}},
                           {{0.3, 9.0, 2.0}, {1.5, 0.0, 1.0}},
                           {{0.3, 9.0, 2.0}, {-1.5, 0.0, 1.0}}},
                          states);
  EXPECT_GT(deepest(out, states), 0.1);
}

// A rollout that is too late to arrive ends early, and never one that would have arrived in time.
TEST_P(Ahead, ARolloutEndsEarlyOnlyWhereItIsTooLate) {
  int late = 0, arrived = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Scene scene = make_scene(model, seed, 4);
    const ControllerParams params = read_params(*model, false);
    Rollout rollout(model, params, 0.04);
    rollout.reset(scene.shapes);
    const Observation o = Loop(model, params, scene).o;
    const auto run = [&](double time, bool late_ends) {
      rollout.begin(o, EscapeState{}, {.time = time, .late_ends = late_ends});
      long budget = 1L << 40;
      rollout.advance(budget);
      return rollout.end();
    };
    if (run(12.0, false) != RolloutEnd::kArrives) continue;
    ++arrived;
    const double time = rollout.time();
    EXPECT_EQ(run(time + 0.1, true), RolloutEnd::kArrives) << "seed " << seed;
    EXPECT_EQ(rollout.time(), time) << "seed " << seed;
    if (run(0.5 * time, true) == RolloutEnd::kLate) {
      ++late;
      EXPECT_LT(rollout.time(), 0.5 * time) << "seed " << seed;
    }
  }
  EXPECT_GT(arrived, 0);
  EXPECT_GT(late, 0);
}

// What is remembered and the observation decide a step, in whatever the robot is about.
TEST_P(Ahead, AStepFollowsFromMemory) {
  int modes[words(Of<PlanMode>{}).size()] = {}, going_on = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = !model->mobile() ? make_scene(model, seed, 12) : behind_a_wall(model, seed);
    ControllerParams params = read_params(*model, true);
    if (seed == 1) params.plan.budget = 20;  // so little that the robot comes to stand while it chooses
    if (seed == 2) params.plan.direct = 0;   // the policy sets out at once
    Loop loop(model, params, scene);
    ControllerCore other(model, params, kPeriod);
    other.reset(scene.shapes);
    StepResult result;
    other.prepare(result);
    ControllerMemory memory;
    for (int i = 0; i < 300; ++i) {
      loop.controller.get_memory(memory);
      ++modes[static_cast<int>(memory.plan.brief.mode)];
      going_on += memory.plan.brief.going_on ? 1 : 0;
      const Observation o = loop.o;
      loop.step();
      other.set_memory(memory);
      other.step(o, result);
      ASSERT_EQ((result.command - loop.result.command).norm(), 0.0)
          << "step " << i << " in mode " << to_string(memory.plan.brief.mode);
    }
  }
  EXPECT_GT(modes[static_cast<int>(PlanMode::kDirect)], 0);
  EXPECT_GT(modes[static_cast<int>(PlanMode::kSetOut)], 0);
  if (!model->mobile()) return;  // whose policy gets there
  EXPECT_GT(going_on, 0);
  EXPECT_GT(modes[static_cast<int>(PlanMode::kChoose)], 0);
  EXPECT_GT(modes[static_cast<int>(PlanMode::kFollow)], 0);
}

// A direct way is looked for from rest, for a quarter of a second at most, and is quicker than the policy.
TEST_P(Ahead, SetsOutAlongADirectWay) {
  double with = 0.0, without = 0.0, least = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    ControllerParams params = read_params(*model, true);
    params.plan.budget = 100;
    Loop loop(model, params, scene);
    const PlanState& state = loop.controller.lookahead()->state();
    int standing = 0;
    loop.step();
    for (; state.brief.mode == PlanMode::kSetOut && standing < 100; ++standing) {
      EXPECT_EQ(loop.result.command.norm(), 0.0);
      loop.step();
    }
    EXPECT_GT(standing, 0);
    EXPECT_LE(standing, 13) << "seed " << seed;
    ASSERT_EQ(state.brief.mode, PlanMode::kFollow) << "seed " << seed;
    EXPECT_EQ(state.brief.reason, PlanReason::kDirectWay);
    with += loop.run(20.0, least);
    EXPECT_EQ(state.brief.attempts, 0) << "it chose on its way";
    ASSERT_TRUE(loop.there()) << "seed " << seed;
    // A goal that jumps as the robot stands is a new start.
    for (int i = 0; i < 100; ++i) loop.step();
    loop.o.goal.X_WG.translation().z() -= 0.1;
    loop.step();
    EXPECT_EQ(state.brief.mode, PlanMode::kSetOut);

    params.plan.direct = 0;
    without += Loop(model, params, scene).run(20.0, least);
  }
  EXPECT_LT(with, 0.98 * without);
}

// The robot goes on in periods that its controller misses, and the path's clock with it.
TEST_P(Ahead, TimePassesOnAPathInMissedPeriods) {
  const ControllerParams params = read_params(*model, true, "moma");
  double all = 0.0, missed = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    double least = 0.0;
    all += Loop(model, params, scene).run(20.0, least);
    Loop loop(model, params, scene);
    for (int k = 1; loop.o.time < 20.0 && !loop.there(); ++k) {
      if (k % 3 == 0 && loop.result.plan.mode == PlanMode::kFollow)
        loop.move();
      else
        loop.step();
    }
    missed += loop.o.time;
  }
  // These ways were timed before a period was missed; a differential base overruns their ends.
  EXPECT_LT(missed, (model->base_dof() == 2 ? 1.5 : 1.15) * all);
}

// A base whose drive follows with half of its accelerations: ways are planned for that.
TEST_P(Ahead, PlansForTheDriveThatItFound) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const ControllerParams params = read_params(*model, true, "moma");
  double longest[2]{};
  for (const bool slow : {false, true}) {
    Loop loop(model, params, make_scene(model, 3, 0));
    ControllerMemory memory;
    loop.controller.get_memory(memory);
    if (slow) memory.prediction.slowing = 0.5;
    loop.controller.set_memory(memory);
    for (int k = 0; k < 50; ++k) {
      loop.step();
      longest[slow] = std::max(longest[slow], loop.result.plan.duration);
    }
  }
  EXPECT_GT(longest[0], 0.0);
  EXPECT_GT(longest[1], 1.05 * longest[0]);
}

// A robot at rest whose policy is predicted to fail stands until it has chosen a path.
TEST_P(Ahead, APolicyThatFailsDoesNotSetOut) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Loop loop(model, read_params(*model, true), behind_a_wall(model, seed));
    const PlanBrief& brief = loop.controller.lookahead()->state().brief;
    int standing = 0, choices = 0;
    for (loop.step(); loop.result.command.isZero(0.0) && standing < 100; loop.step(), ++standing)
      choices = brief.attempts;
    EXPECT_LT(standing, 100) << "seed " << seed;
    EXPECT_EQ(brief.mode, PlanMode::kFollow) << "seed " << seed;
    EXPECT_EQ(brief.reason, PlanReason::kQuicker) << "seed " << seed;
    EXPECT_EQ(choices, 1) << "seed " << seed;
    EXPECT_EQ(brief.attempts, 2) << "the next choice begins as it sets out, seed " << seed;
  }
}

// A path that was chosen in motion counts from where the robot was expected to be.
TEST_P(Ahead, APathIsNotBegunFromElsewhere) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  ControllerParams params = read_params(*model, true);
  params.plan.direct = 0;
  int begun = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const double aside : {0.0, 0.15}) {
      Loop loop(model, params, make_scene(model, seed, 12));
      const PlanState& state = loop.controller.lookahead()->state();
      const auto begins = [&] {
        const GoingOn* now = std::get_if<GoingOn>(&state.doing);
        return now && now->chosen && state.steps == now->commit;
      };
      for (int i = 0; i < 100 && !begins(); ++i) loop.step();
      if (!begins()) break;
      loop.o.base.x() += aside;
      loop.step();
      EXPECT_EQ(state.brief.mode == PlanMode::kFollow, aside == 0.0) << "seed " << seed << ", " << aside << " m beside";
      begun += state.brief.mode == PlanMode::kFollow ? 1 : 0;
    }
  }
  EXPECT_GT(begun, 0);
}

// Towards a goal in motion the policy sets out; a robot in motion without a path has set out already.
TEST_P(Ahead, SetsOutAtRestAndTowardsAGoalAtRest) {
  const Scene scene = make_scene(model, 2, 1);
  const auto first_mode = [&](double velocity, double mover, double goal) {
    ControllerParams params = read_params(*model, true);
    params.plan.budget = 100;
    Loop loop(model, params, scene);
    loop.o.qdot[model->num_velocities() - 1] = velocity;
    loop.o.objects[0].V_WO_W[3] = mover;
    loop.o.goal.V_WG_W[3] = goal;
    loop.step();
    return loop.controller.lookahead()->state().brief.mode;
  };
  EXPECT_EQ(first_mode(0.0, 0.0, 0.0), PlanMode::kSetOut);
  EXPECT_EQ(first_mode(0.3, 0.0, 0.0), PlanMode::kDirect);
  EXPECT_EQ(first_mode(0.0, 0.2, 0.0), PlanMode::kSetOut);
  EXPECT_EQ(first_mode(0.0, 0.0, 0.2), PlanMode::kDirect);
}

// However little it may do in a step.
TEST_P(Ahead, LooksForADirectWayNoLongerThanAQuarterOfASecond) {
  ControllerParams params = read_params(*model, true);
  params.plan.budget = 20;
  Loop loop(model, params, make_scene(model, 1, 0));
  const PlanState& state = loop.controller.lookahead()->state();
  int standing = 0;
  for (loop.step(); state.brief.mode == PlanMode::kSetOut && standing < 100; loop.step()) ++standing;
  EXPECT_EQ(standing, 12);
}

// However little it may do in a step.
TEST_P(Ahead, ARobotThatStandsToChooseGoesOnInTime) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const Scene scene = behind_a_wall(model, 1);
  ControllerParams params = read_params(*model, true);
  params.plan.budget = 20;
  Loop loop(model, params, scene);
  int standing = 0, most = 0;
  for (int i = 0; i < 600; ++i) {
    loop.step();
    const bool chooses = loop.controller.lookahead()->state().brief.mode == PlanMode::kChoose;
    standing = chooses ? standing + 1 : 0;
    most = std::max(most, standing);
  }
  EXPECT_GT(most, 80) << "it never took so long";
  EXPECT_LE(most, 92);
}

TEST_P(Ahead, StepsTakeNoMemoryAndNoMoreThanTheBudget) {
  const Scene scene = !model->mobile() ? make_scene(model, 1, 12) : behind_a_wall(model, 1);
  ControllerParams params = read_params(*model, true);
  params.plan.budget = 300;
  long sum = 0;
  int taken = 0;
  struct Work {
    int direct;
    double rate;
    long checks;  // in a step
  };
  for (const Work& work : {Work{60, 1.5e5, 300}, Work{0, 1.5e5, 300}, Work{60, 100.0 / kPeriod, 100}}) {
    params.plan.direct = work.direct;
    params.plan.rate = work.rate;
    long most = 0;
    Loop loop(model, params, scene);
    for (int i = 0; i < 400; ++i) {
      const NoAlloc guard;
      loop.controller.step(loop.o, loop.result);
      taken += guard.count();
      const long checks = loop.controller.lookahead()->checks();
      most = std::max(most, checks);
      sum += checks;
      loop.step();
      sum += loop.controller.lookahead()->checks();
    }
    EXPECT_LE(most, work.checks + 3 * (FreeSpace::kMostParts + 1));
  }
  EXPECT_EQ(taken, 0);
  EXPECT_GT(sum, 1000);
}

// What comes to stand in a path's way is seen, and the path given up.
TEST_P(Ahead, ABlockedPathIsGivenUp) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  Scene scene = behind_a_wall(model, 1);
  scene.shapes.push_back({"late", make_cylinder(0.25, 1.5)});
  scene.states.resize(2);
  scene.states[1].visible = false;
  ControllerParams params = read_params(*model, true);
  Loop loop(model, params, scene);
  const auto& state = [&]() -> const PlanState& { return loop.controller.lookahead()->state(); };
  for (int i = 0; i < 300 && state().brief.mode != PlanMode::kFollow; ++i) loop.step();
  ASSERT_EQ(state().brief.mode, PlanMode::kFollow);
  // The terms of the cost are those that pull to the path's velocities.
  loop.step();
  double sum = 0.0;
  bool pulled = false;
  for (const TermCost& term : loop.controller.term_costs()) {
    sum += term.value;
    pulled = pulled || term.words == "velocities other than those asked for";
  }
  EXPECT_TRUE(pulled);
  EXPECT_NEAR(sum, loop.controller.cost(), 1e-9 * std::max(1.0, std::abs(sum)));
  WholeConfiguration ahead;
  state().path.at(0.7 * state().path.duration, ahead);
  loop.o.objects[1].visible = true;
  loop.o.objects[1].X_WO.translation() << ahead[0], ahead[1], 0.75;
  bool given_up = false;
  for (int i = 0; i < 10 && !given_up; ++i) {
    loop.step();
    given_up = state().brief.reason == PlanReason::kPathBroken;
  }
  EXPECT_TRUE(given_up);
}

}  // namespace
}  // namespace moma::test
