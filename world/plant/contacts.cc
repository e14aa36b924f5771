#include "world/plant/contacts.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "controller/model/floor_reach.h"
#include "world/holding.h"

namespace moma {
namespace {

// Collision categories: floor against shapes that may reach it, objects against every robot shape.
constexpr unsigned long kArm = 1, kBase = 2, kObject = 4, kFloor = 8;

/// Large enough to leave the degenerate case, far below every tolerance. Different for each solid, so that two boxes of
/// one body differ, too.
Isometry small_turn(ShapeKind kind, std::size_t number) {
  Isometry X = Isometry::Identity();
  if (kind == ShapeKind::kBox) {
    const double angle = 1e-9 * static_cast<double>(number + 1);
    X.linear() = Eigen::AngleAxisd(angle, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  }
  return X;
}

dGeomID make_geom(dSpaceID space, const Shape& shape) {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return dCreateSphere(space, s.x());
    case ShapeKind::kBox:
      return dCreateBox(space, s.x(), s.y(), s.z());
    case ShapeKind::kCapsule:
      return dCreateCapsule(space, s.x(), s.y());
    case ShapeKind::kCylinder:
    case ShapeKind::kConvex:
      break;
  }
  return nullptr;
}

}  // namespace

void ContactLog::add(const Contact& contact) {
  for (Contact& known : contacts_) {
    if (known.kind != contact.kind || known.first != contact.first || known.second != contact.second) continue;
    known.depth = std::max(known.depth, contact.depth);
    return;
  }
  contacts_.push_back(contact);
}

void ContactLog::add(const Touch& touch, double time) {
  double depth = 0.0;
  for (int i = 0; i < touch.count; ++i) depth = std::max(depth, static_cast<double>(touch.points[i].depth));
  add({touch.kind, touch.first, touch.second, depth, time, true});
}

void ContactLog::sort() {
  std::ranges::sort(contacts_, [](const Contact& a, const Contact& b) {
    return std::make_tuple(a.time, a.kind, a.first, a.second) < std::make_tuple(b.time, b.kind, b.first, b.second);
  });
}

ContactScene::ContactScene(std::shared_ptr<const RobotModel> model, const World& world, bool base_meets_floor)
    : model_(std::move(model)), world_(world), states_(world.objects.size()) {
  ode::use_on_this_thread();
  robot_space_ = ode::make_simple_space();
  world_space_ = ode::make_simple_space();
  const std::size_t shapes = model_->shapes.size();
  tags_.reserve(shapes + world_.objects.size() + 1);  // geoms point into it

  const Kinematics upright(model_);
  const std::vector<bool> stands = floor_reach(*model_).stands;
  meets_floor_.assign(shapes, false);
  for (std::size_t i = 0; i < shapes; ++i) {
    const CollisionShape& shape = model_->shapes[i];
    constexpr double kClear = 0.005;
    meets_floor_[i] = !stands[i] || (base_meets_floor && lowest_point(shape.shape, upright.X_WS(shape)) > kClear);
    tags_.push_back({PairKind::kSelf, static_cast<int>(i)});
    radii_.push_back(bounding_radius(shape.shape));
    const dGeomID geom = make_geom(robot_space_.get(), shape.shape);
    robot_geoms_.push_back(geom);
    if (geom == nullptr) continue;
    dGeomSetData(geom, &tags_.back());
    dGeomSetCategoryBits(geom, meets_floor_[i] ? kArm : kBase);
    dGeomSetCollideBits(geom, kObject);
  }
  for (std::size_t i = 0; i < world_.objects.size(); ++i) {
    const WorldObject& object = world_.objects[i];
    tags_.push_back({PairKind::kObject, static_cast<int>(i)});
    if (!at_rest(object.motion, 0.0)) moving_.push_back(static_cast<int>(i));
    const bool carried = model_->carried && model_->carried->object == static_cast<int>(i);
    const dGeomID geom = carried ? nullptr : make_geom(world_space_.get(), object.shape);
    object_geoms_.push_back(geom);
    if (geom == nullptr) continue;
    dGeomSetData(geom, &tags_.back());
    dGeomSetCategoryBits(geom, kObject);
    dGeomSetCollideBits(geom, kArm | kBase);
    ode::set_pose(geom, object.X_WO * small_turn(object.shape.kind, shapes + i));
  }
  tags_.push_back({PairKind::kFloor, -1});
  floor_ = dCreatePlane(world_space_.get(), 0.0, 0.0, 1.0, 0.0);
  dGeomSetData(floor_, &tags_.back());
  dGeomSetCategoryBits(floor_, kFloor);
  dGeomSetCollideBits(floor_, kArm);

  for (const SelfPair& pair : model_->self_pairs)
    if (robot_geom(pair.first) != nullptr && robot_geom(pair.second) != nullptr) self_pairs_.push_back(pair);
  paces_.resize(world_.objects.size());
  moma::object_states(world_, 0.0, states_);
  exact_ = ExactContacts::make(*model_, world_, meets_floor_);
}

Isometry ContactScene::robot_tilt(int shape) const {
  const auto i = static_cast<std::size_t>(shape);
  return small_turn(model_->shapes[i].shape.kind, i);
}

void ContactScene::place_robot(const Kinematics& kinematics) {
  for (std::size_t i = 0; i < robot_geoms_.size(); ++i) {
    if (robot_geoms_[i] == nullptr) continue;
    const CollisionShape& solid = model_->shapes[i];
    const Isometry X_WS = kinematics.X_WS(solid);
    ode::set_pose(robot_geoms_[i], solid.shape.kind == ShapeKind::kBox ? X_WS * robot_tilt(static_cast<int>(i)) : X_WS);
  }
}

void ContactScene::place_objects(double t) {
  const std::size_t shapes = robot_geoms_.size();
  for (const int index : moving_) {
    const auto i = static_cast<std::size_t>(index);
    const MovingPose pose = place(world_.objects[i], paces_[i], t);
    states_[i].X_WO = pose.X;
    states_[i].V_WO_W = pose.V_W;
    if (object_geoms_[i] != nullptr)
      ode::set_pose(object_geoms_[i], pose.X * small_turn(world_.objects[i].shape.kind, shapes + i));
  }
}

void ContactScene::collide(PairKind kind, int first, int second, dGeomID a, dGeomID b, const TouchSink& sink) const {
  dContactGeom points[kPointsPerPair];
  const int count = dCollide(a, b, kPointsPerPair, points, sizeof(dContactGeom));
  if (rests(kind, first, second) &&
      std::all_of(points, points + count, [](const dContactGeom& point) { return point.depth < kPressed; }))
    return;
  if (count > 0) sink({kind, first, second, points, count});
}

bool ContactScene::rests(PairKind kind, int first, int second) const {
  return kind != PairKind::kSelf && model_->stands_on(first, kind == PairKind::kFloor ? kFloorSupport : second);
}

void ContactScene::near(void* data, dGeomID a, dGeomID b) {
  const auto* first = static_cast<const Tag*>(dGeomGetData(a));
  const auto* second = static_cast<const Tag*>(dGeomGetData(b));
  if (first->kind != PairKind::kSelf) {
    std::swap(first, second);
    std::swap(a, b);
  }
  const auto& [scene, sink] = *static_cast<const std::pair<const ContactScene*, const TouchSink*>*>(data);
  scene->collide(second->kind, first->index, second->index, a, b, *sink);
}

void ContactScene::detect(const TouchSink& sink) {
  std::pair<const ContactScene*, const TouchSink*> to{this, &sink};
  dSpaceCollide2(reinterpret_cast<dGeomID>(robot_space_.get()), reinterpret_cast<dGeomID>(world_space_.get()), &to,
                 near);
  for (const SelfPair& pair : self_pairs_) {
    const dGeomID a = robot_geom(pair.first);
    const dGeomID b = robot_geom(pair.second);
    const dReal* p = dGeomGetPosition(a);
    const dReal* q = dGeomGetPosition(b);
    const double reach = radii_[static_cast<std::size_t>(pair.first)] + radii_[static_cast<std::size_t>(pair.second)];
    const double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
    if (dx * dx + dy * dy + dz * dz > reach * reach) continue;
    collide(PairKind::kSelf, pair.first, pair.second, a, b, sink);
  }
}

DetectorCheck ContactScene::cross_check() {
  if (!cross_check_) cross_check_ = std::make_unique<CrossCheck>(*model_, world_);
  return cross_check_->compare(*this);
}

void ContactScene::detect_exact(const Kinematics& kinematics, double time, ContactLog& log) {
  if (!exact_) return;
  exact_found_.clear();
  exact_->detect(kinematics, states_, time, exact_found_);
  for (const Contact& contact : exact_found_)
    if (!rests(contact.kind, contact.first, contact.second) || !(contact.depth < kPressed)) log.add(contact);
}

// Needs no hulls: ODE decides spheres, boxes and capsules.
CrossCheck::CrossCheck(const RobotModel& model, const World& world)
    : shapes_(solids_of(model)), objects_(solids_of(world)), coal_(0) {}

void CrossCheck::judge(bool touches, double distance, DetectorCheck& check) {
  const double contradiction = touches ? distance : -distance;
  if (!(contradiction > kTolerance)) return;
  ++check.disagreements;
  check.deepest = std::max(check.deepest, contradiction);
}

void CrossCheck::compare_pair(const Solid& a, dGeomID geom_a, const Solid& b, dGeomID geom_b, bool touches,
                              DetectorCheck& check) {
  const Isometry X_WA = ode::pose(geom_a);
  const Isometry X_WB = ode::pose(geom_b);
  // Solids with disjoint bounding spheres are apart.
  const bool far = (X_WA.translation() - X_WB.translation()).norm() > a.radius + b.radius;
  if (far && !touches) return;
  judge(touches, coal_.distance(a.geometry, X_WA, b.geometry, X_WB).d, check);
}

DetectorCheck CrossCheck::compare(ContactScene& scene) {
  std::vector<Touch> touches;
  scene.detect([&](const Touch& touch) { touches.push_back(touch); });
  const auto touched = [&](PairKind kind, int first, int second) {
    return std::ranges::any_of(touches, [&](const Touch& touch) {
      return touch.kind == kind && touch.first == first && touch.second == second;
    });
  };
  DetectorCheck check;
  for (int i = 0; i < static_cast<int>(shapes_.size()); ++i) {
    const dGeomID robot = scene.robot_geom(i);
    if (robot == nullptr) continue;
    const Solid& shape = shapes_[static_cast<std::size_t>(i)];
    for (int k = 0; k < static_cast<int>(objects_.size()); ++k) {
      const dGeomID object = scene.object_geom(k);
      if (object != nullptr && !scene.rests(PairKind::kObject, i, k))
        compare_pair(shape, robot, objects_[static_cast<std::size_t>(k)], object, touched(PairKind::kObject, i, k),
                     check);
    }
    if (scene.meets_floor()[static_cast<std::size_t>(i)] && !scene.rests(PairKind::kFloor, i, -1))
      judge(touched(PairKind::kFloor, i, -1), lowest_point(shape.shape, ode::pose(robot)), check);
  }
  for (const SelfPair& pair : scene.self_pairs())
    compare_pair(shapes_[static_cast<std::size_t>(pair.first)], scene.robot_geom(pair.first),
                 shapes_[static_cast<std::size_t>(pair.second)], scene.robot_geom(pair.second),
                 touched(PairKind::kSelf, pair.first, pair.second), check);
  return check;
}

}  // namespace moma
