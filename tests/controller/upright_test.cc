// An upright tool: the tilt and its row against differences, and what rows, plans and whole motions keep of it.
#include "controller/model/upright.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/controller_core.h"
#include "controller/plan/direct_way.h"
#include "tests/controller/plan_scenes.h"
#include "tests/support/finite_difference.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

constexpr double kAngle = 0.26;

/// The axis of E that is vertical at `ready`.
Upright upright_at_ready(const std::shared_ptr<const RobotModel>& model, double angle) {
  return {Kinematics(model).X_WE().linear().transpose().col(2), angle};
}

double tilt_of(const Upright& upright, const std::shared_ptr<const RobotModel>& model, const WholeConfiguration& c) {
  Kinematics kinematics(model);
  kinematics.update(c.head<3>(), c.tail(model->num_joints()));
  const Vector3 u = kinematics.X_WE().linear() * upright.axis.normalized();
  return std::acos(std::clamp(u.z(), -1.0, 1.0));
}

/// A scene whose goal the arm reaches upright, with the tilt `tilted`.
Scene upright_scene(const std::shared_ptr<const RobotModel>& model, const Upright& upright, std::uint64_t seed,
                    double tilted, int count) {
  Kinematics kinematics(model);
  std::mt19937_64 engine(seed);
  for (;; seed += 1000) {
    Scene scene = make_scene(model, seed, 0);
    VectorX low(model->num_joints()), high = low, q = model->ready;
    for (int i = 0; i < model->num_joints(); ++i) {
      const ControlledJoint& joint = model->joints[static_cast<std::size_t>(i)];
      const bool bounded = std::isfinite(joint.lower);
      low[i] = bounded ? joint.lower + 0.3 : -3.0;
      high[i] = bounded ? joint.upper - 0.3 : 3.0;
      q[i] = uniform_in(engine, low[i], high[i]);
    }
    kinematics.update(model->mobile() ? Vector3(2.5, 0.5, 0.3) : Vector3::Zero(), q);
    if (bring_upright(upright, tilted, low, high, kinematics, q) < 0) continue;
    if (own_clearance(*model, kinematics) < 0.005 || kinematics.X_WE().translation().z() < 0.2) continue;
    scene.X_WG = kinematics.X_WE();
    while (static_cast<int>(scene.shapes.size()) < count) {
      Scene one = scene;
      one.shapes = {{"one", make_sphere(0.12)}};
      one.states.resize(1);
      one.states[0].X_WO.translation() << uniform_in(engine, -0.8, 2.5), uniform_in(engine, -0.8, 0.8),
          uniform_in(engine, 0.2, 1.0);
      Kinematics start(model);
      start.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));
      if (object_clearance(*model, start, one) < 0.12 || object_clearance(*model, kinematics, one) < 0.12) continue;
      scene.shapes.push_back({"o" + std::to_string(scene.shapes.size()), one.shapes[0].shape});
      scene.states.push_back(one.states[0]);
    }
    return scene;
  }
}

Observation at_start(const RobotModel& model, const Scene& scene, const Upright& upright) {
  Observation o;
  o.base = scene.start.head<3>();
  o.q = scene.start.tail(model.num_joints());
  o.qdot = VectorX::Zero(model.num_velocities());
  o.goal.X_WG = scene.X_WG;
  o.objects = scene.states;
  o.upright = upright;
  return o;
}

ControllerParams upright_params(const RobotModel& model) {
  ControllerParams params = plan_params(model);
  params.upright.enabled = true;
  return params;
}

int upright_rows(const QpProblem& p) {
  int rows = 0;
  for (int r = 0; r < p.rows; ++r) rows += p.ids[static_cast<std::size_t>(r)].kind == RowKind::kUpright ? 1 : 0;
  return rows;
}

TEST(Upright, TiltIsTheAngleToTheVertical) {
  const Upright along_x{Vector3(2.0, 0.0, 0.0), 0.1};
  EXPECT_NEAR(tilt(along_x, Matrix3(Matrix3::Identity())), std::numbers::pi / 2, 1e-15);
  for (const double angle : {1e-8, 0.3, 1.5, 3.1}) {
    // Turned from the vertical about y, then about z.
    const Matrix3 R = (Eigen::AngleAxisd(0.7, Vector3::UnitZ()) * Eigen::AngleAxisd(angle, Vector3::UnitY())).matrix();
    EXPECT_NEAR(tilt(Upright{}, R), angle, 1e-9 * angle);
  }
  EXPECT_EQ(tilt_direction(Upright{}, Matrix3::Identity()), Vector3(Vector3::Zero()));
}

// The row of the QP times any velocity is the rate of the tilt, and a base changes no tilt.
TEST(Upright, RowIsTheRateOfTheTilt) {
  std::mt19937 engine(3);
  for (const char* robot : {"configs/robots/frankie.yaml", "configs/robots/lift_ur5.yaml"}) {
    const auto model = load_model(robot);
    ControllerCore controller(model, upright_params(*model), 0.02);
    StepResult result;
    controller.prepare(result);
    const QpProblem& p = controller.problem();
    for (int k = 0; k < 20; ++k) {
      const State state = random_state(*model, engine);
      Observation o;
      o.base = state.base;
      o.q = state.q;
      o.qdot = VectorX::Zero(model->num_velocities());
      o.goal.X_WG.translation() << 1.0, 1.0, 1.0;
      controller.reset({});
      controller.step(o, result);
      EXPECT_EQ(upright_rows(p), 0) << "untold";
      o.upright = Upright{Vector3(0.3, -0.5, 2.0), kAngle};
      controller.reset({});
      controller.step(o, result);
      ASSERT_EQ(upright_rows(p), 1);
      int row = 0;
      while (p.ids[static_cast<std::size_t>(row)].kind != RowKind::kUpright) ++row;
      EXPECT_EQ(controller.row_name(row), "upright");
      const auto tilt_after = [&](const VectorX& v) {
        Kinematics kinematics(model);
        Vector3 base = state.base;
        VectorX q = state.q;
        integrate(*model, base, q, v, 1.0);
        kinematics.update(base, q);
        return std::acos((kinematics.X_WE().linear() * o.upright->axis.normalized()).z());
      };
      const double h = difference_step();
      for (int i = 0; i < model->num_velocities(); ++i) {
        const VectorX step = h * VectorX::Unit(model->num_velocities(), i);
        EXPECT_NEAR(p.A(row, i), (tilt_after(step) - tilt_after(-step)) / (2.0 * h), 1e-7) << i;
        if (i < model->base_dof()) {
          EXPECT_EQ(p.A(row, i), 0.0);
        }
      }
      // Beyond the angle, and the goal's own tilt, the bound asks for the way back.
      const double allowed = std::max((1.0 - UprightParams{}.margin) * kAngle,
                                      std::min(kAngle, std::acos(o.upright->axis.normalized().z())));
      EXPECT_EQ(p.ubA[row]<0.0, tilt_after(VectorX::Zero(model->num_velocities()))> allowed);
    }
  }
}

TEST(Upright, ArmsAreBroughtThereWithinTheirLimits) {
  std::mt19937 engine(4);
  const auto model = load_model("configs/robots/frankie.yaml");
  Kinematics kinematics(model);
  const VectorX low = Kinematics(model).q().array() - 3.0, high = Kinematics(model).q().array() + 3.0;
  int brought = 0;
  for (int k = 0; k < 100; ++k) {
    VectorX q = random_state(*model, engine).q.cwiseMax(low).cwiseMin(high);
    const NoAlloc guard;
    const int updates = bring_upright(Upright{}, 0.1, low, high, kinematics, q);
    EXPECT_EQ(guard.count(), 0);
    if (updates < 0) continue;
    ++brought;
    kinematics.update(Vector3::Zero(), q);
    EXPECT_LE(tilt(Upright{}, kinematics), 0.1 + 1e-3);
    EXPECT_TRUE((q.array() >= low.array()).all() && (q.array() <= high.array()).all());
  }
  EXPECT_GT(brought, 90);
}

class UprightOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Robots, UprightOf, testing::Values("configs/robots/frankie.yaml", "configs/robots/panda.yaml"),
                         [](const auto& param) { return test_name(param.param); });

// Planned paths and direct ways: every moment of what is found is upright, and untold most of them are not.
TEST_P(UprightOf, PlansAndWaysKeepTheToolUpright) {
  const auto model = load_model(GetParam());
  const ControllerParams params = upright_params(*model);
  const Upright upright = upright_at_ready(model, kAngle);
  const double most = params.upright.plan * kAngle + 1e-3;
  Planner planner(model, params);
  DirectWay way(model, params);
  int paths = 0, ways = 0, spilled = 0;
  const auto largest = [&](const Path& path) {
    double worst = 0.0;
    WholeConfiguration c;
    for (double t = 0.0; t <= path.duration; t += 0.01) {
      path.at(t, c);
      worst = std::max(worst, tilt_of(upright, model, c));
    }
    return worst;
  };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = upright_scene(model, upright, seed, 0.1, 4);
    planner.keep_upright({});
    spilled += plan_whole(planner, scene, seed) && largest(planner.path()) > kAngle ? 1 : 0;
    planner.keep_upright(upright);
    if (plan_whole(planner, scene, seed)) {
      ++paths;
      EXPECT_LE(largest(planner.path()), most) << "plan " << seed;
    }
    way.set_objects(scene.shapes);
    way.keep_upright(upright);
    MotionState start{scene.start, WholeConfiguration::Zero(scene.start.size())};
    way.begin(start, scene.X_WG, scene.states);
    long budget = 1L << 40;
    way.advance(budget);
    if (!way.found()) continue;
    ++ways;
    EXPECT_LE(largest(way.path()), most) << "way " << seed;
  }
  EXPECT_GE(paths, 8);
  EXPECT_GE(spilled, 4) << "the scenes ask for nothing";
  EXPECT_GE(ways, 1);
}

// Whole motions without physics: told, the cup is not spilled.
TEST_P(UprightOf, MotionsKeepTheToolUpright) {
  const auto model = load_model(GetParam());
  const Upright upright = upright_at_ready(model, kAngle);
  for (const bool enabled : {true, false}) {
    ControllerParams params = plan_params(*model);
    params.upright.enabled = enabled;
    int arrived = 0, spilled = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const Scene scene = upright_scene(model, upright, 20 + seed, 0.1, 3);
      ControllerCore controller(model, params, 0.02);
      controller.reset(scene.shapes);
      StepResult result;
      controller.prepare(result);
      Observation o = at_start(*model, scene, upright);
      double worst = 0.0;
      for (int k = 0; k < 1000; ++k) {
        controller.step(o, result);
        integrate(*model, o.base, o.q, result.command, 0.02);
        o.qdot = result.command;
        o.time += 0.02;
        WholeConfiguration c(3 + model->num_joints());
        c << o.base, o.q;
        worst = std::max(worst, tilt_of(upright, model, c));
        if (result.error.tail<3>().norm() < 0.01 && result.error.head<3>().norm() < 0.03) {
          ++arrived;
          break;
        }
      }
      spilled += worst > kAngle ? 1 : 0;
    }
    EXPECT_EQ(spilled > 0, !enabled) << spilled;
    EXPECT_GE(arrived, 3);
  }
}

}  // namespace
}  // namespace moma::test
