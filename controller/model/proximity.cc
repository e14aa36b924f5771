#include "controller/model/proximity.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "controller/model/convex_distance.h"
#include "controller/model/floor_reach.h"

namespace moma {
namespace {

// A box in world axes around a placed solid: the bounding box of a box, a cylinder or a capsule (a little larger for
// a cylinder), the cube around the ball of another.
Eigen::AlignedBox3d box_around(const Solid& solid, const Isometry& X_WS) noexcept {
  const Vector3& size = solid.shape.size;
  Vector3 half = Vector3::Constant(solid.radius);
  if (solid.shape.kind == ShapeKind::kBox)
    half = 0.5 * (X_WS.linear().cwiseAbs() * size);
  else if (solid.shape.kind == ShapeKind::kCylinder || solid.shape.kind == ShapeKind::kCapsule)
    half = (0.5 * size[1] * X_WS.linear().col(2).cwiseAbs()).array() + size[0];
  return {X_WS.translation() - half, X_WS.translation() + half};
}

int hull_vertices(const Shape& shape) { return shape.hull ? static_cast<int>(shape.hull->vertices.size()) : 0; }

}  // namespace

struct Proximity::Impl {
  std::shared_ptr<const RobotModel> model;
  std::vector<Solid> robot;
  std::vector<bool> stands;  // of the robot: no pair with the floor
  std::vector<Solid> objects;
  std::optional<ConvexDistance> convex;                                  // sized by set_objects()
  int vertices = 0;                                                      // for which it has room
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> robot_X_WS;  // the shapes' frames in the world
  struct Around {
    Eigen::AlignedBox3d box;
    std::size_t object;
  };
  std::span<const ObjectState> held;
  std::vector<Around> around, near;  // the held objects, and those near the robot
  std::vector<ProximityPair> pairs;

  // The carried object is no obstacle but the last shape of the robot.
  int carried() const noexcept {
    return model->carried && model->carried->object < static_cast<int>(objects.size()) ? model->carried->object : -1;
  }
  const Solid& solid(std::size_t i) const noexcept {
    const int object = i + 1 == robot.size() ? carried() : -1;
    return object < 0 ? robot[i] : objects[static_cast<std::size_t>(object)];
  }
  // Number of shapes that are there.
  std::size_t present() const noexcept { return robot.size() - (model->spare && carried() < 0 ? 1 : 0); }
  bool there(std::size_t i, int second) const noexcept { return i < present() && (second < 0 || second != carried()); }
  bool stands_on(std::size_t i, int second) const noexcept { return model->stands_on(static_cast<int>(i), second); }
  bool counts(std::size_t i, int second) const noexcept { return there(i, second) && !stands_on(i, second); }

  // Returns the distance if it is less than `range`, after cheap lower bounds.
  std::optional<Distance> within(const Solid& a, const Isometry& X_Wa, const Solid& b, const Isometry& X_Wb,
                                 double range) noexcept {
    if (apart(a, X_Wa, b, X_Wb, range)) return {};
    const Distance distance = signed_distance(a, X_Wa, b, X_Wb, *convex);
    if (!(distance.d < range)) return {};
    return distance;
  }

  // Returns the distance of a shape from the held object that it stands on as if it were raised above that.
  std::optional<Distance> above_support(std::size_t i, std::size_t j, const ProximityRanges& ranges) noexcept {
    Isometry X_WS = robot_X_WS[i];
    X_WS.translation().z() += ranges.raised;
    auto distance = within(solid(i), X_WS, objects[j], held[j].X_WO, ranges.of(held[j]));
    if (distance) distance->p_first_W.z() -= ranges.raised;
    return distance;
  }

  void fit(std::size_t j, const ObjectState& state) noexcept {
    Solid& solid = objects[j];
    if (state.box.x() > 0.0 && solid.shape.kind == ShapeKind::kBox && solid.shape.size != state.box)
      resize_box(solid, state.box);
  }

  // Takes the visible objects with valid poses.
  void hold(std::span<const ObjectState> states) noexcept {
    held = states;
    around.clear();
    for (std::size_t j = 0; j < std::min(states.size(), objects.size()); ++j) {
      if (!states[j].visible || !is_pose(states[j].X_WO)) continue;
      fit(j, states[j]);
      around.push_back({box_around(objects[j], states[j].X_WO), j});
    }
  }

  bool place(const Kinematics& kinematics) noexcept {
    const std::vector<CollisionShape>& shapes = model->shapes;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      robot_X_WS[i] = kinematics.X_WS(shapes[i]);
      if (!is_pose(robot_X_WS[i])) return false;
    }
    return true;
  }

  std::optional<Distance> to_floor(std::size_t i, double range) const noexcept {
    if (stands[i] || !(robot_X_WS[i].translation().z() - solid(i).radius < range) || !counts(i, kFloorSupport))
      return {};
    Distance distance;
    distance.d = lowest_point(solid(i).shape, robot_X_WS[i], &distance.p_first_W);
    distance.p_second_W = distance.p_first_W;
    distance.p_second_W.z() = 0.0;
    if (!(distance.d < range)) return {};
    return distance;
  }

  // Calls found(pair) for every pair inside its range, in the fixed order, until it returns false.
  template <class Found>
  void each(const Kinematics& kinematics, const ProximityRanges& ranges, Found&& found) noexcept {
    const std::size_t count = present();
    if (!place(kinematics)) return;
    if (ranges.object >= 0.0) {
      Eigen::AlignedBox3d robot_box;
      for (std::size_t i = 0; i < count; ++i) robot_box.extend(box_around(solid(i), robot_X_WS[i]));
      // Objects out of range of the robot's box are out of range of each shape; `apart` decides the others.
      constexpr double kRounding = 1e-5;
      const double reach = (ranges.object + kRounding) * (ranges.object + kRounding);
      near.clear();
      for (const Around& object : around)
        if (!(robot_box.squaredExteriorDistance(object.box) > reach)) near.push_back(object);
      for (std::size_t i = 0; i < count; ++i) {
        const Eigen::AlignedBox3d box = box_around(solid(i), robot_X_WS[i]);
        for (const Around& object : near) {
          if (box.squaredExteriorDistance(object.box) > reach) continue;
          const std::size_t j = object.object;
          if (!there(i, static_cast<int>(j))) continue;
          const bool rests = stands_on(i, static_cast<int>(j));
          if (rests && ranges.raised < 0.0) continue;
          const auto d = rests ? above_support(i, j, ranges)
                               : within(solid(i), robot_X_WS[i], objects[j], held[j].X_WO, ranges.of(held[j]));
          if (d && !found(ProximityPair{PairKind::kObject, static_cast<int>(i), static_cast<int>(j), *d})) return;
        }
      }
    }
    if (ranges.floor >= 0.0) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto d = to_floor(i, ranges.floor);
        if (d && !found(ProximityPair{PairKind::kFloor, static_cast<int>(i), -1, *d})) return;
      }
    }
    if (ranges.self >= 0.0) {
      for (const SelfPair& pair : model->self_pairs) {
        const auto a = static_cast<std::size_t>(pair.first);
        const auto b = static_cast<std::size_t>(pair.second);
        if (!pair.row || b >= count || model->may_touch(pair)) continue;
        const auto d = within(solid(a), robot_X_WS[a], solid(b), robot_X_WS[b], ranges.self);
        if (d && !found(ProximityPair{PairKind::kSelf, pair.first, pair.second, *d})) return;
      }
    }
  }
};

Proximity::Proximity(std::shared_ptr<const RobotModel> model) : impl_(std::make_unique<Impl>()) {
  impl_->model = std::move(model);
  for (const CollisionShape& shape : impl_->model->shapes) impl_->robot.emplace_back(shape.shape);
  impl_->stands = floor_reach(*impl_->model).stands;
  impl_->robot_X_WS.resize(impl_->robot.size(), Isometry::Identity());
  set_objects({});
}

Proximity::~Proximity() = default;
Proximity::Proximity(Proximity&&) noexcept = default;
Proximity& Proximity::operator=(Proximity&&) noexcept = default;

void Proximity::set_objects(std::span<const ObjectShape> objects) {
  Impl& impl = *impl_;
  impl.objects.clear();
  for (const ObjectShape& object : objects) impl.objects.emplace_back(object.shape);
  int vertices = 0;
  for (const auto* solids : {&impl.robot, &impl.objects})
    for (const Solid& solid : *solids) vertices = std::max(vertices, hull_vertices(solid.shape));
  if (!impl.convex || vertices > impl.vertices) {
    impl.convex.emplace(vertices);
    impl.vertices = vertices;
  }
  impl.held = {};
  for (auto* list : {&impl.around, &impl.near}) {
    list->clear();
    list->reserve(impl.objects.size());
  }
  impl.pairs.clear();
  impl.pairs.reserve(impl.robot.size() * (impl.objects.size() + 1) + impl.model->self_pairs.size());
}

void Proximity::hold(std::span<const ObjectState> states) noexcept { impl_->hold(states); }

std::span<const ProximityPair> Proximity::query(const Kinematics& kinematics, std::span<const ObjectState> states,
                                                const ProximityRanges& ranges) noexcept {
  hold(states);
  return query(kinematics, ranges);
}

std::span<const ProximityPair> Proximity::query(const Kinematics& kinematics, const ProximityRanges& ranges) noexcept {
  impl_->pairs.clear();
  impl_->each(kinematics, ranges, [&](const ProximityPair& pair) {
    impl_->pairs.push_back(pair);
    return true;
  });
  return impl_->pairs;
}

bool Proximity::clear(const Kinematics& kinematics, std::span<const ObjectState> states,
                      const ProximityRanges& ranges) noexcept {
  hold(states);
  return clear(kinematics, ranges);
}

bool Proximity::clear(const Kinematics& kinematics, const ProximityRanges& ranges) noexcept {
  bool none = true;
  impl_->each(kinematics, ranges, [&](const ProximityPair&) { return none = false; });
  return none;
}

bool Proximity::place(const Kinematics& kinematics) noexcept { return impl_->place(kinematics); }

std::optional<Distance> Proximity::within(PairKind kind, int first, int second, std::span<const ObjectState> states,
                                          double range) noexcept {
  Impl& impl = *impl_;
  const auto a = static_cast<std::size_t>(first);
  if (kind == PairKind::kFloor) return impl.to_floor(a, range);
  const auto b = static_cast<std::size_t>(second);
  if (kind == PairKind::kSelf && (b >= impl.present() || impl.model->may_touch({first, second}))) return {};
  if (kind == PairKind::kSelf)
    return impl.within(impl.solid(a), impl.robot_X_WS[a], impl.solid(b), impl.robot_X_WS[b], range);
  if (!impl.counts(a, second)) return {};
  impl.fit(b, states[b]);
  return impl.within(impl.solid(a), impl.robot_X_WS[a], impl.objects[b], states[b].X_WO, range);
}

double Proximity::least_gap(int shape, int object, const Isometry& X_WO) const noexcept {
  const auto i = static_cast<std::size_t>(shape);
  return moma::least_gap(impl_->solid(i), impl_->robot_X_WS[i], impl_->objects[static_cast<std::size_t>(object)], X_WO);
}

bool is_pose(const Isometry& X) noexcept {
  return X.linear().squaredNorm() < 3.1 && X.translation().allFinite();  // 3 for a rotation
}

Distance shape_distance(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2) {
  if (const auto exact = analytic_distance(first, X_W1, second, X_W2)) return *exact;
  const int vertices = std::max(hull_vertices(first), hull_vertices(second));
  return ConvexDistance(vertices).distance(convex_geometry(first), X_W1, convex_geometry(second), X_W2);
}

}  // namespace moma
