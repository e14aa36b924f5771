#include "world/plant/exact_contacts.h"

#include <algorithm>

#include "controller/model/analytic_distance.h"

namespace moma {
namespace {

// The distance library reports some overlaps of up to 1e-5 m as a gap below this [m].
constexpr double kUnsure = 2e-5;

/// Nearest point of a solid; not for hulls.
Vector3 nearest_in(const Shape& shape, const Isometry& X_WS, const Vector3& p_W) {
  const Vector3 p = X_WS.linear().transpose() * (p_W - X_WS.translation());
  const PointDistance to = point_distance(shape, p);
  return to.d <= 0.0 ? p_W : X_WS * Vector3(p - to.d * to.n_S);
}

/// True if alternating projections from p_W find a common point of both solids, which never happens if they are apart.
bool share_a_point(const Shape& A, const Isometry& X_WA, const Shape& B, const Isometry& X_WB, Vector3 p_W) {
  constexpr int kMostIterations = 500;
  constexpr double kSame = 1e-12;  // [m]
  if (A.kind == ShapeKind::kConvex || B.kind == ShapeKind::kConvex) return false;
  for (int i = 0; i < kMostIterations; ++i) {
    const Vector3 a = nearest_in(A, X_WA, p_W);
    p_W = nearest_in(B, X_WB, a);
    if ((a - p_W).norm() < kSame) return true;
  }
  return false;
}

bool hard(const Shape& shape) { return !decided_by_ode(shape.kind); }

std::shared_ptr<const RobotModel> with_hard_pairs(const RobotModel& model) {
  auto copy = std::make_shared<RobotModel>(model);
  copy->self_pairs.clear();
  for (SelfPair pair : model.self_pairs) {
    if (!hard(model.shape(pair.first).shape) && !hard(model.shape(pair.second).shape)) continue;
    pair.row = true;
    copy->self_pairs.push_back(pair);
  }
  return copy;
}

}  // namespace

std::unique_ptr<ExactContacts> ExactContacts::make(const RobotModel& model, const World& world,
                                                   const std::vector<bool>& meets_floor) {
  const bool any = std::ranges::any_of(model.shapes, [](const auto& s) { return hard(s.shape); }) ||
                   std::ranges::any_of(world.objects, [](const auto& o) { return hard(o.shape); });
  if (!any) return nullptr;
  return std::unique_ptr<ExactContacts>(new ExactContacts(with_hard_pairs(model), world, meets_floor));
}

ExactContacts::ExactContacts(std::shared_ptr<const RobotModel> model, const World& world,
                             const std::vector<bool>& meets_floor)
    : model_(std::move(model)), proximity_(model_), meets_floor_(meets_floor) {
  proximity_.set_objects(object_shapes(world));
  for (const CollisionShape& shape : model_->shapes) hard_shape_.push_back(hard(shape.shape));
  for (const WorldObject& object : world.objects) {
    hard_object_.push_back(hard(object.shape));
    objects_.push_back(object.shape);
  }
}

bool ExactContacts::overlaps(const ProximityPair& pair, const Kinematics& kinematics,
                             const std::vector<ObjectState>& states) const {
  const double d = pair.distance.d;
  if (d <= 0.0) return true;
  const CollisionShape& first = model_->shape(pair.first);
  const auto second = static_cast<std::size_t>(pair.second);
  const bool self = pair.kind == PairKind::kSelf;
  const Shape& other = self ? model_->shapes[second].shape : objects_[second];
  const Isometry X_WO = self ? kinematics.X_WS(model_->shapes[second]) : states[second].X_WO;
  const Vector3 middle = 0.5 * (pair.distance.p_first_W + pair.distance.p_second_W);
  return share_a_point(first.shape, kinematics.X_WS(first), other, X_WO, middle);
}

void ExactContacts::detect(const Kinematics& kinematics, const std::vector<ObjectState>& states, double time,
                           std::vector<Contact>& found) {
  for (const ProximityPair& pair : proximity_.query(kinematics, states, {kUnsure, -1.0, kUnsure})) {
    const auto first = static_cast<std::size_t>(pair.first);
    const auto second = static_cast<std::size_t>(pair.second);
    if (pair.kind == PairKind::kObject && !hard_shape_[first] && !hard_object_[second]) continue;
    if (overlaps(pair, kinematics, states))
      found.push_back({pair.kind, pair.first, pair.second, std::max(0.0, -pair.distance.d), time, false});
  }
  for (std::size_t i = 0; i < model_->shapes.size(); ++i) {
    if (!hard_shape_[i] || !meets_floor_[i]) continue;
    const double lowest = lowest_point(model_->shapes[i].shape, kinematics.X_WS(model_->shapes[i]));
    if (lowest < 0.0) found.push_back({PairKind::kFloor, static_cast<int>(i), -1, -lowest, time, false});
  }
}

}  // namespace moma
