// Trapezoids, edges and the timing of paths against differences and against what a base can do.
#include <gtest/gtest.h>

#include <numbers>

#include "controller/plan/follow.h"
#include "controller/plan/steered_drive.h"
#include "tests/controller/plan_scenes.h"

namespace moma::test {
namespace {

class PlanMotion : public testing::TestWithParam<std::string> {
 protected:
  PlanMotion() : model(load_model(GetParam())), limits(*model, plan_params(*model)) {}

  WholeConfiguration anywhere(std::mt19937_64& engine) const {
    WholeConfiguration c(3 + limits.num_joints());
    c.head<3>() << uniform_in(engine, -2, 2), uniform_in(engine, -2, 2), uniform_in(engine, -4, 4);
    if (!limits.mobile()) c.head<3>().setZero();
    for (int i = 0; i < limits.num_joints(); ++i) c[3 + i] = uniform_in(engine, limits.lower[i], limits.upper[i]);
    return c;
  }

  std::shared_ptr<const RobotModel> model;
  MotionLimits limits;
};

INSTANTIATE_TEST_SUITE_P(Robots, PlanMotion, testing::ValuesIn(plan_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST(Trapezoid, IsTheQuickestInsideItsLimits) {
  for (const double length : {0.01, 0.3, 2.0, 7.0}) {
    for (const double speed : {0.2, 1.0, 2.0}) {
      for (const double acceleration : {0.5, 4.0}) {
        const Trapezoid motion = quickest_way(length, speed, acceleration);
        // Bang-bang: full acceleration to the middle or to the top speed.
        const double flat = length - speed * speed / acceleration;
        const double least =
            flat > 0.0 ? 2.0 * speed / acceleration + flat / speed : 2.0 * std::sqrt(length / acceleration);
        EXPECT_NEAR(motion.time, least, 1e-12) << length << " m";
        const int n = 2000;
        const double h = motion.time / n;
        double top = 0.0, hardest = 0.0;
        for (int i = 1; i < n; ++i) {
          const double before = motion.part(h * (i - 1)), now = motion.part(h * i), after = motion.part(h * (i + 1));
          top = std::max(top, length * (after - before) / (2.0 * h));
          hardest = std::max(hardest, length * std::abs(after - 2.0 * now + before) / (h * h));
        }
        EXPECT_LE(top, speed * (1.0 + 1e-9));
        EXPECT_LE(hardest, acceleration * (1.0 + 1e-6));
        EXPECT_GE(std::max(top / speed, hardest / acceleration), 0.999);
      }
    }
  }
}

// Plans of a robot whose cameras do not look behind it turn by up to `facing` more, in order to drive forwards.
TEST(MotionLimits, DriveForwardsWhereNoCameraLooksBehind) {
  const auto drives = [](const std::vector<std::string>& sensors, double facing) {
    RobotModel model = *load_model("configs/robots/frankie_cameras.yaml");
    std::erase_if(model.sensors, [&](const MountedSensor& mounted) {
      return std::ranges::find(sensors, mounted.sensor.name) == sensors.end();
    });
    ControllerParams params = plan_params(model);
    params.map.enabled = params.map.unseen.enabled = true;
    params.map.unseen.facing = facing;
    const MotionLimits limits(model, params);
    // To points at 80, 110, 140 and 175 degrees to the left: an edge to a heading across, and a drive that steers,
    // which turns left if it goes forwards.
    std::string out;
    for (const double bearing : {1.4, 1.92, 2.44, 3.05}) {
      WholeConfiguration a = WholeConfiguration::Zero(3 + limits.num_joints()), b = a;
      b.head<3>() << std::cos(bearing), std::sin(bearing), bearing - 0.5 * std::numbers::pi;
      Edge edge;
      make_edge(limits, a, b, edge);
      SteeredDrive drive;
      EXPECT_TRUE(drive.plan(limits, a.head<3>(), Vector2::Zero(), b.head<2>()));
      out += {edge.drive > 0.0 ? 'f' : 'b', drive.end().z() > 0.0 ? 'f' : 'b'};
    }
    return out;
  };
  const std::vector<std::string> ahead{"front_camera", "rear_scanner"}, around{"front_camera", "rear_camera"};
  EXPECT_EQ(drives(around, 2.0), "ffbbbbbb") << "the shorter turn decides";
  EXPECT_EQ(drives(ahead, 0.0), "ffbbbbbb");
  EXPECT_EQ(drives(ahead, 1.0), "ffffbbbb");
  EXPECT_EQ(drives(ahead, 2.0), "ffffffbb");
}

TEST_P(PlanMotion, EdgesEndWhereTheyShould) {
  std::mt19937_64 engine(1);
  Edge edge;
  WholeConfiguration c;
  for (int k = 0; k < 200; ++k) {
    const WholeConfiguration a = anywhere(engine), b = anywhere(engine);
    make_edge(limits, a, b, edge);
    edge_at(limits, edge, 0.0, c);
    EXPECT_LT((c - a).lpNorm<Eigen::Infinity>(), 1e-12);
    edge_at(limits, edge, edge.time, c);
    c[2] = b[2] + wrapped(c[2] - b[2]);
    EXPECT_LT((c - b).lpNorm<Eigen::Infinity>(), 1e-9);
    EXPECT_EQ(edge.time, edge_time(limits, a, b));
  }
}

// A path of a robot in motion begins at its velocity; it can be made to begin earlier.
TEST_P(PlanMotion, APathBeginsAtTheVelocityThatABrakingHas) {
  std::mt19937_64 engine(6);
  for (int k = 0; k < 20; ++k) {
    const WholeConfiguration a = anywhere(engine), b = anywhere(engine);
    Edge edge;
    make_edge(limits, a, b, edge);
    Braking braking{a, 0.4};
    WholeConfiguration v = WholeConfiguration::Zero(a.size());
    for (int i = 0; i < limits.num_joints(); ++i)
      v[3 + i] = uniform_in(engine, -0.8, 0.8) * 0.4 * limits.joint_acceleration[i];
    braking.from -= 0.2 * v;
    Path path;
    ASSERT_TRUE(lay_path(limits, std::span(&edge, 1), 0.35, braking, path));
    const double h = 1e-4;
    WholeConfiguration before = braking.from, now, after;
    path.at(h, now);
    EXPECT_LT(((now - before) / h - v).lpNorm<Eigen::Infinity>(), 5e-3);
    for (double t = 2.0 * h; t < 1.0; t += h) {
      path.at(t, after);
      const WholeConfiguration acceleration = (after - 2.0 * now + before) / (h * h);
      for (int i = 0; i < limits.num_joints(); ++i)
        ASSERT_LE(std::abs(acceleration[3 + i]), 1.001 * limits.joint_acceleration[i]) << "joint " << i << " at " << t;
      before = now;
      now = after;
    }
    Path earlier = path;
    earlier.begin_earlier(0.1);
    EXPECT_NEAR(earlier.duration, path.duration + 0.1, 1e-12);
    for (const double t : {0.0, 0.2, 0.7 * path.duration, path.duration}) {
      path.at(t, now);
      earlier.at(t + 0.1, after);
      EXPECT_LT((after - now).lpNorm<Eigen::Infinity>(), 1e-9) << t;
    }
    earlier.at(0.0, now);
    EXPECT_LT((now - (braking.from - 0.1 * v)).lpNorm<Eigen::Infinity>(), 1e-9);
  }
}

// A tree grows from the goals backwards: what was checked has to be what is driven.
TEST_P(PlanMotion, EdgesBackwardsVisitTheSamePlaces) {
  std::mt19937_64 engine(2);
  Edge there, back;
  WholeConfiguration c, d;
  for (int k = 0; k < 200; ++k) {
    const WholeConfiguration a = anywhere(engine), b = anywhere(engine);
    make_edge(limits, a, b, there);
    make_edge(limits, b, a, back);
    ASSERT_NEAR(there.time, back.time, 1e-9);
    for (int i = 0; i <= 20; ++i) {
      edge_at(limits, there, there.time * i / 20, c);
      edge_at(limits, back, back.time * (20 - i) / 20, d);
      d[2] = c[2] + wrapped(d[2] - c[2]);
      ASSERT_LT((c - d).lpNorm<Eigen::Infinity>(), 1e-6) << "pair " << k << " at " << i;
    }
  }
}

TEST_P(PlanMotion, ADifferentialBaseNeverGoesSideways) {
  if (!limits.base->nonholonomic()) GTEST_SKIP() << "only for a differential base";
  std::mt19937_64 engine(3);
  Edge edge;
  WholeConfiguration before, now, after;
  for (int k = 0; k < 100; ++k) {
    make_edge(limits, anywhere(engine), anywhere(engine), edge);
    const double h = 1e-5;
    for (int i = 1; i < 40; ++i) {
      const double t = edge.time * i / 40;
      edge_at(limits, edge, t - h, before);
      edge_at(limits, edge, t, now);
      edge_at(limits, edge, t + h, after);
      const Vector2 v = (after - before).head<2>() / (2.0 * h);
      // Where a turn becomes a drive the difference spans both.
      EXPECT_LT(std::abs(-std::sin(now[2]) * v.x() + std::cos(now[2]) * v.y()), 1e-4) << "edge " << k << " at " << t;
    }
  }
}

// Speeds and accelerations of whole paths, overlaps included, by differences.
TEST_P(PlanMotion, PathsStayInsideSpeedsAndAccelerations) {
  std::mt19937_64 engine(4);
  double fullest = 0.0;
  for (int k = 0; k < 40; ++k) {
    EdgeList edges;
    Edge edge;
    WholeConfiguration a = anywhere(engine);
    for (int i = 0; i < 5; ++i) {
      const WholeConfiguration b = anywhere(engine);
      make_edge(limits, a, b, edge);
      edges.push(edge);
      a = b;
    }
    Path path;
    ASSERT_TRUE(lay_path(limits, edges.all(), 0.35, {}, path));
    EXPECT_LE(path.duration, edges.time() + 1e-9);
    WholeConfiguration end;
    path.at(path.duration, end);
    end[2] = a[2] + wrapped(end[2] - a[2]);
    EXPECT_LT((end - a).lpNorm<Eigen::Infinity>(), 1e-9);
    const double h = 0.002;
    WholeConfiguration before, now, after;
    for (double t = h; t < path.duration; t += h) {
      path.at(t - h, before);
      path.at(t, now);
      path.at(t + h, after);
      const WholeConfiguration v = (after - before) / (2.0 * h);
      const WholeConfiguration acc = (after - 2.0 * now + before) / (h * h);
      constexpr double kMore = 1.0 + 1e-6;
      if (limits.mobile()) {
        ASSERT_LE(v.head<2>().norm(), kMore * limits.linear) << "path " << k << " at " << t;
        ASSERT_LE(acc.head<2>().norm(), kMore * limits.linear_acceleration) << "path " << k << " at " << t;
        ASSERT_LE(std::abs(v[2]), kMore * limits.angular) << "path " << k << " at " << t;
        ASSERT_LE(std::abs(acc[2]), kMore * limits.angular_acceleration) << "path " << k << " at " << t;
      }
      for (int i = 0; i < limits.num_joints(); ++i) {
        ASSERT_LE(std::abs(v[3 + i]), kMore * limits.joint_speed[i]) << "joint " << i << " at " << t;
        ASSERT_LE(std::abs(acc[3 + i]), kMore * limits.joint_acceleration[i]) << "joint " << i << " at " << t;
        fullest = std::max(fullest, std::abs(v[3 + i]) / limits.joint_speed[i]);
      }
    }
  }
  EXPECT_GT(fullest, 0.95) << "no path ever reached a speed: the bounds above say nothing";
}

// A unicycle, a mecanum base and joints that start beside the path come back to it.
TEST_P(PlanMotion, FollowingComesBackToThePath) {
  std::mt19937_64 engine(5);
  for (int k = 0; k < 20; ++k) {
    EdgeList edges;
    Edge edge;
    WholeConfiguration a = anywhere(engine), b = anywhere(engine);
    make_edge(limits, a, b, edge);
    edges.push(edge);
    Path path;
    ASSERT_TRUE(lay_path(limits, edges.all(), 0.0, {}, path));
    Observation o;
    o.base = a.head<3>();
    if (limits.mobile()) o.base += Vector3(0.03, -0.04, 0.1);
    o.q = a.tail(limits.num_joints()).array() + 0.05;
    o.qdot = VectorX::Zero(model->num_velocities());
    VectorX u = o.qdot;
    const PlanParams params = plan_params(*model).plan;
    double t = 0.0;
    FollowStep step;
    for (int i = 0; i < 3000 && (t < path.duration || i < 200); ++i) {
      step = follow_path(limits, params, path, t, 0.02, 1.0, {}, o, u);
      integrate(*model, o.base, o.q, u, 0.02);
      t = std::min(t + 0.02 * step.rate, path.duration);
    }
    EXPECT_GE(t, path.duration) << "path " << k;
    EXPECT_LT(step.lag, 0.05) << "path " << k;
  }
}

TEST(PlanarShift, TakesTheGoalToWhereItIsSeen) {
  std::mt19937 engine(6);
  for (int k = 0; k < 50; ++k) {
    const Isometry then = random_pose(engine, 3.0);
    const double turn = 0.02 * k - 0.5;
    const Vector2 move(0.1 * k, -0.05 * k);
    const Isometry drift = base_pose({move.x(), move.y(), turn});
    const PlanarShift shift = shift_of_goal(true, then, drift * then);
    EXPECT_NEAR(shift.turn, turn, 1e-12);
    EXPECT_LT((shift.move - move).norm(), 1e-12);
    WholeConfiguration c = WholeConfiguration::Zero(4);
    c << 1.0, 2.0, 0.3, 0.7;
    const Isometry moved = drift * base_pose(c.head<3>());
    const WholeConfiguration shifted = shift.of(c);
    EXPECT_LT((shifted.head<2>() - moved.translation().head<2>()).norm(), 1e-12);
    EXPECT_NEAR(shifted[2], 0.3 + turn, 1e-12);
    EXPECT_EQ(shifted[3], 0.7);
    EXPECT_EQ(shift_of_goal(false, then, drift * then).turn, 0.0);
  }
}

}  // namespace
}  // namespace moma::test
