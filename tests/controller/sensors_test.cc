// Rays against marching by distances (the distance library), frames against every ray by itself, and memory of what is
// no longer told of.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "controller/model/proximity.h"
#include "controller/model/sensor_frames.h"
#include "controller/params.h"
#include "controller/safe/object_memory.h"
#include "tests/support/control_period.h"
#include "tests/support/no_alloc.h"
#include "tests/support/shapes.h"
#include "tests/support/tiny_robot.h"

namespace moma::test {
namespace {

// On from a point by its distance to the solid, again and again: reaches the surface from outside, and only there.
double march(const Shape& shape, const Vector3& from, const Vector3& u, double range) {
  const Shape point = make_sphere(1e-9);
  double t = 0.0;
  for (int i = 0; i < 2000 && t < range; ++i) {
    const double d = shape_distance(point, placed(from + t * u), shape, Isometry::Identity()).d;
    if (i == 0 && d <= 0.0) return kInfinity;
    if (d < 1e-7) return t;
    t += d;
  }
  return kInfinity;
}

TEST(RayDistance, IsWhatMarchingByTheDistanceReaches) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<> place(-0.6, 0.6);
  std::normal_distribution<> normal;
  for (const ShapeKind kind :
       {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule, ShapeKind::kConvex}) {
    int hits = 0, inside = 0;
    for (int i = 0; i < 400; ++i) {
      const Shape shape = random_shape(kind, engine);
      const Vector3 from(place(engine), place(engine), place(engine));
      // Half of them at something inside, so that enough of them hit.
      const Vector3 at = shape.hull ? Vector3(shape.hull->vertices[0] * 0.5 + shape.hull->vertices[1] * 0.5)
                                    : Vector3(0.02 * normal(engine), 0.02 * normal(engine), 0.02 * normal(engine));
      const Vector3 to = i % 2 == 0 ? at : Vector3(place(engine), place(engine), place(engine));
      const Vector3 u = (to - from).normalized();
      const double wanted = march(shape, from, u, 3.0), found = ray_distance(shape, from, u);
      const double grazing = found < kInfinity && wanted == kInfinity ? found : 0.0;
      if (grazing > 0.0) continue;  // marching gives up along a surface; the other way round is an error
      if (wanted == kInfinity) {
        EXPECT_EQ(found, kInfinity) << to_string(kind) << ' ' << i;
        if (found == kInfinity) ++inside;
      } else {
        ++hits;
        EXPECT_NEAR(found, wanted, 1e-4) << to_string(kind) << ' ' << i;
      }
    }
    EXPECT_GT(hits, 100) << to_string(kind);
    EXPECT_GT(inside, 20) << to_string(kind);
  }
}

TEST(RayDistance, BeginsOutside) {
  for (const Shape& shape : {make_sphere(0.2), make_box(0.3, 0.3, 0.3), make_cylinder(0.2, 0.4), make_capsule(0.2, 0.4),
                             make_octahedron(0.3, 0.3, 0.3)})
    for (const Vector3& u : {Vector3(1, 0, 0), Vector3(0, 0, 1), Vector3(0.6, 0, -0.8)})
      EXPECT_EQ(ray_distance(shape, Vector3(0.01, 0.02, 0.03), u), kInfinity) << to_string(shape.kind);
}

Sensor camera(double azimuth, double elevation, int columns, int rows) {
  Sensor sensor;
  sensor.name = "camera";
  sensor.field_of_view = {azimuth, elevation};
  sensor.columns = columns;
  sensor.rows = rows;
  sensor.range = 2.5;
  return sensor;
}

// Windows leave no ray out: every ray against every solid gives the same frame.
TEST(RayView, EveryRayMeetsTheNearestSolid) {
  std::mt19937 engine(5);
  for (const Sensor& sensor : {camera(1.5, 1.2, 40, 30), camera(2 * std::numbers::pi, 3.1, 60, 31),
                               camera(4.7, 0.0, 200, 1), camera(2 * std::numbers::pi, 0.0, 90, 1)}) {
    RayView view(sensor);
    int met = 0;
    for (int frame = 0; frame < 10; ++frame) {
      const Isometry X_WC = random_pose(engine, 0.3);
      std::vector<std::pair<Shape, Isometry>> solids;
      for (int i = 0; i < 12; ++i)
        solids.emplace_back(random_shape(static_cast<ShapeKind>(i % 5), engine), random_pose(engine, 1.2));
      view.begin(X_WC);
      for (std::size_t i = 0; i < solids.size(); ++i) view.draw(solids[i].first, solids[i].second, static_cast<int>(i));
      for (std::size_t ray = 0; ray < view.ids().size(); ++ray) {
        double least = kInfinity;
        int id = RayView::kNothing;
        for (std::size_t i = 0; i < solids.size(); ++i) {
          const Isometry X_SC = solids[i].second.inverse() * X_WC;
          const double d = ray_distance(solids[i].first, X_SC.translation(), X_SC.linear() * view.directions_C()[ray]);
          if (d >= least || d > sensor.range) continue;
          least = d;
          id = static_cast<int>(i);
        }
        ASSERT_EQ(view.ids()[ray], id) << "ray " << ray << " of frame " << frame;
        if (id >= 0) {
          ++met;
          ASSERT_NEAR(view.distances()[ray], least, 1e-9);
        }
      }
    }
    EXPECT_GT(met, 50);
  }
}

TEST(RayView, RaysAreEvenlySpacedAboutTheMiddle) {
  const RayView view(camera(1.2, 0.8, 3, 2));
  EXPECT_TRUE(view.directions_C()[1].isApprox(Vector3(std::cos(0.2), 0, -std::sin(0.2)), 1e-12));
  EXPECT_TRUE(view.directions_C()[3].isApprox(
      Vector3(std::cos(0.2) * std::cos(0.4), -std::cos(0.2) * std::sin(0.4), std::sin(0.2)), 1e-12));
}

// The tiny robot with a camera that looks ahead from 0.8 m, above its arm.
std::shared_ptr<const RobotModel> seeing_robot(double rate = 10.0) {
  auto model = std::make_shared<RobotModel>(*tiny_robot());
  Sensor sensor = camera(1.2, 1.2, 80, 60);
  sensor.rate = rate;
  MountedSensor mounted{sensor, 0, placed({0, 0, 0.8})};
  model->sensors.push_back(mounted);
  return model;
}

struct RayScene {
  std::vector<ObjectShape> shapes = {{"wall", make_box(0.1, 0.6, 0.6)}, {"ball", make_sphere(0.1)}};
  Observation told;

  explicit RayScene(const RobotModel& model) {
    told.q = model.ready;
    told.qdot = VectorX::Zero(model.num_velocities());
    told.objects.resize(2);
    told.objects[0].X_WO.translation() = Vector3(1.2, 1.5, 0.8);  // out of the way
    told.objects[1].X_WO.translation() = Vector3(2.0, 0.0, 0.8);
  }
};

TEST(SensorFrames, FallDueAtTheirRateAndSeeWhatIsNotHidden) {
  const auto model = seeing_robot();
  SensorFrames frames(*model, kPeriod);
  RayScene scene(*model);
  frames.set_objects(std::vector<Shape>{scene.shapes[0].shape, scene.shapes[1].shape});
  Kinematics robot(model);
  robot.place(Vector3::Zero(), scene.told.q);
  int taken = 0;
  for (long k = 0; k < 50; ++k) {
    frames.look(k, robot, scene.told.objects);
    taken += frames.due(0) ? 1 : 0;
  }
  EXPECT_EQ(taken, 10);  // a second at 10 frames a second
  EXPECT_NEAR(frames.interval(0), 0.1, 1e-12);
  const int clear = frames.rays_on(1);
  EXPECT_GT(clear, 20);
  scene.told.objects[0].X_WO.translation() = Vector3(1.2, 0.0, 0.8);
  frames.look(0, robot, scene.told.objects);
  EXPECT_EQ(frames.rays_on(1), 0) << "behind the wall";
  EXPECT_GT(frames.rays_on(0), 100);
  scene.told.objects[0].visible = false;
  frames.look(0, robot, scene.told.objects);
  EXPECT_EQ(frames.rays_on(1), clear) << "the wall is not there";
  frames.look(1, robot, scene.told.objects);
  EXPECT_EQ(frames.rays_on(1), clear) << "the latest frame counts until the next";
}

// Steps for so long as the ball is believed in when it is told of for `shown` seconds and then no more.
struct Remembering {
  std::shared_ptr<const RobotModel> model;
  MemoryParams params{.enabled = true};
  RayScene scene{*model};

  int believed(double shown, double at_most) {
    ObjectMemory memory(*model, params, kPeriod);
    memory.set_objects(scene.shapes);
    const PoseFilter filter({}, {}, kPeriod);
    std::vector<PoseTrack> tracks(2);
    std::vector<ObjectState> out(2);
    int steps = 0;
    for (long k = 0; k * kPeriod < shown + at_most; ++k) {
      scene.told.time = static_cast<double>(k) * kPeriod;
      scene.told.objects[1].visible = k * kPeriod < shown - 1e-9;
      for (std::size_t i = 0; i < 2; ++i) {
        out[i] = scene.told.objects[i];
        if (out[i].visible) {
          filter.measure(out[i].X_WO, out[i].V_WO_W, tracks[i]);
        } else {
          out[i].visible = memory.believes(tracks[i]);
          if (out[i].visible)
            filter.coast(tracks[i]);
          else
            tracks[i] = {};
        }
        out[i].X_WO = tracks[i].X_W();
      }
      const NoAlloc none;
      memory.look(scene.told, out, tracks);
      EXPECT_EQ(none.count(), 0);
      if (!scene.told.objects[1].visible && out[1].visible) ++steps;
    }
    return steps;
  }
};

TEST(ObjectMemory, KeepsWhatIsOutOfViewAndDropsWhatIsLookedThrough) {
  Remembering seen{seeing_robot()};
  // In full view and not told of: gone after 0.6 s of frames, 0.1 s each.
  EXPECT_NEAR(seen.believed(1.0, 5.0) * kPeriod, 0.6, 0.1);
  // The robot looks away: it stays.
  seen.scene.told.base.z() = 2.0;
  EXPECT_EQ(seen.believed(0.5, 5.0), 250);
  seen.scene.told.base.z() = 0.0;
  // Hidden by a wall that is told of: it stays.
  seen.scene.told.objects[0].X_WO.translation() = Vector3(1.2, 0.0, 0.8);
  EXPECT_EQ(seen.believed(0.5, 5.0), 250);
  // Beyond the sensor's range: it stays.
  seen.scene.told.objects[0].X_WO.translation() = Vector3(1.2, 1.5, 0.8);
  seen.scene.told.objects[1].X_WO.translation().x() = 4.0;
  EXPECT_EQ(seen.believed(0.5, 5.0), 250);
}

TEST(ObjectMemory, WhatWasShownForAMomentGoesInAMoment) {
  Remembering seen{seeing_robot()};
  EXPECT_NEAR(seen.believed(0.06, 1.0) * kPeriod, 0.1, 0.1);
  seen.scene.told.base.z() = 2.0;
  EXPECT_EQ(seen.believed(0.06, 1.0), 50) << "it cannot be looked through";
  seen.params.enabled = false;
  EXPECT_EQ(seen.believed(0.5, 1.0), 0);
}

TEST(ObjectMemory, WhatMovesAndWhatNoSensorCanLookAtIsKeptForAWhile) {
  Remembering seen{seeing_robot()};
  seen.scene.told.base.z() = 2.0;
  seen.scene.told.objects[1].V_WO_W.tail<3>() = Vector3(0.2, 0, 0);
  EXPECT_NEAR(seen.believed(0.5, 5.0) * kPeriod, 1.0, 0.03);
  Remembering blind{tiny_robot()};
  EXPECT_NEAR(blind.believed(0.5, 5.0) * kPeriod, 1.0, 0.03);
}

}  // namespace
}  // namespace moma::test
