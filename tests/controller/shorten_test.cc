// Shortcuts and pulls of a path's edges, against coal's distances and the edges' own times.
#include "controller/plan/shorten.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "controller/plan/free_space.h"
#include "tests/controller/plan_scenes.h"

namespace moma::test {
namespace {

constexpr double kClearance = 0.02, kCheckStep = 0.04;

// A Panda turns about a column in front of it, with its arm folded and wrist and forearm turned on the way for nothing.
class Shorten : public testing::Test {
 protected:
  Shorten()
      : model(load_model("configs/robots/panda.yaml")), limits(*model, plan_params(*model)), space(model, limits) {
    scene.shapes = {{"column", make_box(0.1, 0.1, 1.2)}};
    scene.states.resize(1);
    scene.states[0].X_WO.translation() << 0.5, 0.0, 0.6;
    WholeConfiguration c = WholeConfiguration::Zero(3 + model->num_joints());
    c.tail(model->num_joints()) = model->ready;
    const auto corner = [&](double turn, double shoulder, double forearm, double elbow, double wrist) {
      c.segment<4>(3) << turn, shoulder, forearm, elbow;
      c[9] = wrist;
      corners.push_back(c);
    };
    corner(-0.9, 0.1, 0.0, -2.0, 0.8);
    corner(-0.9, -1.3, 0.5, -2.6, 2.2);
    corner(0.0, -1.3, -0.5, -2.6, -0.8);
    corner(0.9, -1.3, 0.5, -2.6, 2.0);
    corner(0.9, 0.1, 0.0, -2.0, 0.8);
    space.set_objects(scene.shapes);
    space.set_states(scene.states);
    space.set_clearances({kClearance, -1.0, -1.0}, corners.front());
  }
  EdgeList edges() const {
    EdgeList list;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      Edge edge;
      make_edge(limits, corners[k], corners[k + 1], edge);
      list.push(edge);
    }
    return list;
  }
  double least(const Edge& edge) const {
    Kinematics kinematics(model);
    WholeConfiguration c;
    double least = 1e9;
    for (int k = 0; k <= 50; ++k) {
      edge_point(limits, edge, k / 50.0, c);
      kinematics.update(c.head<3>(), c.tail(model->num_joints()));
      least = std::min(least, object_clearance(*model, kinematics, scene));
    }
    return least;
  }
  // The time after `tries`; each is taken where the edges get quicker, and only there.
  double shortened(bool pulls, int tries) {
    EdgeList list = edges(), work;
    CountedDraws draws{7, 0};
    for (int k = 0; k < tries; ++k) {
      const double before = list.time();
      if (try_shortcut(space, kCheckStep, k, pulls, draws, list, work))
        EXPECT_LT(list.time(), before - 0.019) << k;
      else
        EXPECT_EQ(list.time(), before) << k;
    }
    EXPECT_LT((list[0].a - corners.front()).norm(), 1e-9);
    EXPECT_LT((list.all().back().b - corners.back()).norm(), 1e-9);
    for (std::size_t k = 0; k < list.size(); ++k) {
      // Half of a check's way may pass between two checks.
      EXPECT_GT(least(list[k]), kClearance - 0.5 * kCheckStep) << k;
      EXPECT_TRUE(k == 0 || list[k].a == list[k - 1].b) << k;
    }
    return list.time();
  }

  std::shared_ptr<const RobotModel> model;
  MotionLimits limits;
  FreeSpace space;
  Scene scene;
  std::vector<WholeConfiguration> corners;
};

TEST_F(Shorten, PullsTakeOutWhatJointsTurnForNothing) {
  const EdgeList drawn = edges();
  for (const Edge& edge : drawn.all()) ASSERT_GT(least(edge), kClearance);
  Edge straight;
  make_edge(limits, corners.front(), corners.back(), straight);
  ASSERT_LT(least(straight), 0.0) << "no shortcut joins the ends";
  const double alone = shortened(false, 400), pulled = shortened(true, 400);
  std::printf("%.2f s of edges; %.2f s by shortcuts alone, %.2f s with pulls, %.2f s straight through the column\n",
              drawn.time(), alone, pulled, straight.time);
  EXPECT_LT(alone, drawn.time());
  EXPECT_LT(pulled, 0.9 * alone);
}

}  // namespace
}  // namespace moma::test
