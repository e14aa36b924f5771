// The least distances against those of every state, each asked for anew.
#include "eval/trial/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/config/robot_file.h"
#include "tests/eval/trial_fixture.h"
#include "world/draws.h"

namespace moma::test {
namespace {

struct Least {
  double objects = std::nan(""), itself = std::nan("");

  void look(Proximity& proximity, const Kinematics& kinematics, const std::vector<ObjectState>& states) {
    for (const ProximityPair& pair : proximity.query(kinematics, states, {1e6, -1.0, 1e6})) {
      double& least = pair.kind == PairKind::kSelf ? itself : objects;
      if (!(least <= pair.distance.d)) least = pair.distance.d;
    }
  }
};

void expect_same(double a, double b, const std::string& where) {
  ASSERT_EQ(std::isnan(a), std::isnan(b)) << where;
  if (!std::isnan(a)) {
    ASSERT_EQ(a, b) << where;
  }
}

World world_of(Draws& draws, int objects) {
  constexpr std::array kKinds{ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCapsule, ShapeKind::kCylinder};
  World world;
  for (int k = 0; k < objects; ++k) {
    const ShapeKind kind = kKinds[static_cast<std::size_t>(k) % kKinds.size()];
    world.objects.emplace_back();
    world.objects.back().shape = {kind, Vector3(0.1, 0.2, 0.3), nullptr};
    world.objects.back().X_WO.translation() =
        Vector3(draws.uniform(-1.2, 1.2), draws.uniform(-1.2, 1.2), draws.uniform(0.0, 2.0));
  }
  return world;
}

TEST(Clearance, IsThatOfEveryStateToTheLastBit) {
  const std::string folder = std::string(MOMA_SOURCE_DIR) + "/configs/robots/";
  const std::array robots{tiny_spec().robot->model, config::load_robot(folder + "frankie.yaml").model,
                          config::load_robot(folder + "lift_ur5.yaml").model};
  int lower = 0;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::shared_ptr<const RobotModel>& model = robots[r];
    for (std::uint64_t run = 0; run < 60; ++run) {
      Draws draws(8, run, Stream::kMotion);
      const World world = world_of(draws, static_cast<int>(run % 5) * 2);
      const bool objects_move = run % 3 == 2;
      std::vector<ObjectState> states(world.objects.size());
      object_states(world, 0.0, states);
      Proximity proximity(model);
      proximity.set_objects(object_shapes(world));
      ClearanceWatch watch;
      Kinematics kinematics(model);
      Least plain;
      Vector3 base = Vector3::Zero();
      VectorX q = model->ready;
      VectorX v = VectorX::Zero(model->num_velocities());
      for (int k = 0; k < 60; ++k) {
        const std::string where =
            "robot " + std::to_string(r) + ", run " + std::to_string(run) + ", state " + std::to_string(k);
        kinematics.update(base, q);
        watch.look(kinematics, proximity, states);
        const Least before = plain;
        plain.look(proximity, kinematics, states);
        if (plain.objects < before.objects || plain.itself < before.itself) ++lower;
        expect_same(watch.to_objects(), plain.objects, where);
        expect_same(watch.to_itself(), plain.itself, where);
        if (HasFatalFailure()) return;
        // The base stands in every other run. Beyond limits as well, and a jump as a plant that has failed may make.
        if (k % 15 == 0)
          for (Eigen::Index i = 0; i < v.size(); ++i) {
            const bool stands = i < model->base_dof() && run % 2 == 0;
            v[i] = stands ? 0.0 : draws.uniform(-2.0, 2.0);
          }
        integrate(*model, base, q, v, k == 49 ? 1.0 : 0.02);
        if (objects_move)
          for (std::size_t o = 0; o < states.size(); o += 2)
            states[o].X_WO =
                states[o].X_WO * Eigen::Translation3d(0.01, 0.005, 0.0) * Eigen::AngleAxisd(0.05, Vector3::UnitZ());
      }
    }
  }
  EXPECT_GT(lower, 300);
}

}  // namespace
}  // namespace moma::test
