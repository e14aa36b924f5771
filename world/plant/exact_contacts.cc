#include "world/plant/exact_contacts.h"

#include <algorithm>

namespace moma {
namespace {

constexpr double kRange = 0.1;      // gaps beyond it count as this [m]
constexpr double kRounding = 1e-5;  // of distances between hulls [m]

bool hard(const Shape& shape) { return !decided_by_ode(shape.kind); }

std::shared_ptr<const RobotModel> with_hard_pairs(const RobotModel& model) {
  auto copy = std::make_shared<RobotModel>(model);
  copy->self_pairs.clear();
  for (SelfPair pair : model.self_pairs) {
    if (!hard(model.shapes[static_cast<std::size_t>(pair.first)].shape) &&
        !hard(model.shapes[static_cast<std::size_t>(pair.second)].shape))
      continue;
    pair.row = true;
    copy->self_pairs.push_back(pair);
  }
  return copy;
}

}  // namespace

std::unique_ptr<ExactContacts> ExactContacts::make(const RobotModel& model, const World& world,
                                                   const std::vector<bool>& meets_floor) {
  const bool any = std::any_of(model.shapes.begin(), model.shapes.end(), [](const auto& s) { return hard(s.shape); }) ||
                   std::any_of(world.objects.begin(), world.objects.end(), [](const auto& o) { return hard(o.shape); });
  if (!any) return nullptr;
  return std::unique_ptr<ExactContacts>(new ExactContacts(with_hard_pairs(model), world, meets_floor));
}

ExactContacts::ExactContacts(std::shared_ptr<const RobotModel> model, const World& world,
                             const std::vector<bool>& meets_floor)
    : model_(std::move(model)), proximity_(model_), meets_floor_(meets_floor) {
  proximity_.set_objects(object_shapes(world));
  for (const CollisionShape& shape : model_->shapes) {
    hard_shape_.push_back(hard(shape.shape));
    radii_.push_back(bounding_radius(shape.shape));
  }
  for (const WorldObject& object : world.objects) {
    hard_object_.push_back(hard(object.shape));
    object_radii_.push_back(bounding_radius(object.shape));
  }
  ranges_ = {kRange, -1.0, kRange};
}

double ExactContacts::motion_since(const Kinematics& kinematics, const std::vector<ObjectState>& states) const {
  // No point of a solid has moved farther than its centre and, at its radius, its rotation together.
  const auto moved = [](const Isometry& a, const Isometry& b, double radius) {
    return (a.translation() - b.translation()).norm() + radius * (a.linear() - b.linear()).norm();
  };
  double robot = 0.0, object = 0.0;
  for (std::size_t i = 0; i < radii_.size(); ++i)
    robot = std::max(robot, moved(kinematics.X_WS(model_->shapes[i]), X_WS_[i], radii_[i]));
  for (std::size_t i = 0; i < states.size(); ++i)
    object = std::max(object, moved(states[i].X_WO, X_WO_[i], object_radii_[i]));
  return robot + std::max(robot, object);
}

void ExactContacts::remember(const Kinematics& kinematics, const std::vector<ObjectState>& states, double gap) {
  gap_ = gap;
  X_WS_.resize(radii_.size());
  X_WO_.resize(states.size());
  for (std::size_t i = 0; i < radii_.size(); ++i) X_WS_[i] = kinematics.X_WS(model_->shapes[i]);
  for (std::size_t i = 0; i < states.size(); ++i) X_WO_[i] = states[i].X_WO;
}

void ExactContacts::detect(const Kinematics& kinematics, const std::vector<ObjectState>& states, double time,
                           std::vector<Contact>& found) {
  if (gap_ > kRounding && motion_since(kinematics, states) < gap_ - kRounding) return;
  double gap = kRange;
  for (const ProximityPair& pair : proximity_.query(kinematics, states, ranges_)) {
    const auto first = static_cast<std::size_t>(pair.first);
    const auto second = static_cast<std::size_t>(pair.second);
    if (pair.kind == PairKind::kObject && !hard_shape_[first] && !hard_object_[second]) continue;
    gap = std::min(gap, pair.distance.d);
    if (pair.distance.d <= 0.0) found.push_back({pair.kind, pair.first, pair.second, -pair.distance.d, time, false});
  }
  for (std::size_t i = 0; i < model_->shapes.size(); ++i) {
    if (!hard_shape_[i] || !meets_floor_[i]) continue;
    const double lowest = lowest_point(model_->shapes[i].shape, kinematics.X_WS(model_->shapes[i]));
    gap = std::min(gap, lowest);
    if (lowest < 0.0) found.push_back({PairKind::kFloor, static_cast<int>(i), -1, -lowest, time, false});
  }
  remember(kinematics, states, gap);
}

}  // namespace moma
