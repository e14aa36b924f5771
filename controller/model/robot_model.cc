#include "controller/model/robot_model.h"

#include <cstddef>
#include <iterator>

#include "controller/model/base_kind.h"

namespace moma {
namespace {

constexpr std::string_view kUnicycle[] = {"v", "omega"};
constexpr std::string_view kPlanar[] = {"v_x", "v_y", "omega"};

constexpr std::string_view kTwoWheels[] = {"left", "right"};
constexpr std::string_view kFourWheels[] = {"front_left", "front_right", "rear_left", "rear_right"};

// Lynch & Park 2017, 13.3.
Vector3 driven_wheel(const Wheels& w, int wheel) noexcept {
  const double side = wheel == 0 ? -1.0 : 1.0;
  return {1.0 / w.radius, side * w.separation / (2.0 * w.radius), 0.0};
}

// The map of docs/reference/conventions.md.
Vector3 mecanum_wheel(const Wheels& w, int wheel) noexcept {
  const double k = 0.5 * (w.wheelbase + w.separation);
  static constexpr double kSideways[] = {-1.0, 1.0, 1.0, -1.0};
  static constexpr double kTurn[] = {-1.0, 1.0, -1.0, 1.0};
  return Vector3(1.0, kSideways[wheel], kTurn[wheel] * k) / w.radius;
}

// In the order of BaseType.
constexpr BaseKind kKinds[] = {
    {},
    {kUnicycle, kTwoWheels, false, driven_wheel},
    {kPlanar, kFourWheels, true, mecanum_wheel},
};
static_assert(std::size(kKinds) == words(Of<BaseType>{}).size());

}  // namespace

const BaseKind& kind_of(BaseType type) noexcept { return kKinds[static_cast<std::size_t>(type)]; }

int num_wheels(const MobileBase& base) noexcept {
  return base.wheels ? static_cast<int>(kind_of(base.type).wheel_names.size()) : 0;
}

int wheel_speeds(const MobileBase& base, const Eigen::Ref<const VectorX>& velocity, Eigen::Vector4d& speeds) noexcept {
  const int wheels = num_wheels(base);
  const BaseKind& kind = kind_of(base.type);
  for (int i = 0; i < wheels; ++i) {
    const Vector3 row = kind.wheel_row(*base.wheels, i);
    double sum = 0.0;
    for (int j = 0; j < kind.dof(); ++j) sum += row[j] * velocity[j];
    speeds[i] = sum;
  }
  return wheels;
}

int RobotModel::base_dof() const noexcept { return kind_of(base.type).dof(); }

int RobotModel::rigid_root(int link) const noexcept {
  while (link > 0 && links[static_cast<std::size_t>(link)].controlled < 0)
    link = links[static_cast<std::size_t>(link)].parent;
  return link;
}

std::vector<int> RobotModel::hand_shapes() const {
  std::vector<int> hand;
  const int root = rigid_root(tip);
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (rigid_root(shapes[i].link) == root) hand.push_back(static_cast<int>(i));
  return hand;
}

std::shared_ptr<RobotModel> with_spare_shape(const RobotModel& model) {
  auto out = std::make_shared<RobotModel>(model);
  const int spare = static_cast<int>(model.shapes.size());
  const int hand = model.rigid_root(model.tip);
  for (int i = 0; i < spare; ++i)
    if (model.rigid_root(model.shape(i).link) != hand) out->self_pairs.push_back({i, spare, true});
  out->shapes.push_back({"carried", model.tip, {}, model.X_TE, hand == 0});
  out->spare = true;
  return out;
}

void carry(RobotModel& model, const std::optional<Carried>& carried, const Shape* shape) noexcept {
  model.carried = carried;
  CollisionShape& spare = model.shapes.back();
  if (!carried) return;
  spare.shape = *shape;
  spare.X_LS = model.X_TE * carried->X_EO;
}

int RobotModel::find_link(std::string_view link_name) const noexcept {
  for (std::size_t i = 0; i < links.size(); ++i)
    if (links[i].name == link_name) return static_cast<int>(i);
  return -1;
}

VectorX RobotModel::velocity_limits() const {
  VectorX limits(num_velocities());
  int k = 0;
  for (; k < base_dof() - 1; ++k) limits[k] = base.max_linear;
  if (base_dof() > 0) limits[k++] = base.max_angular;
  for (const ControlledJoint& joint : joints) limits[k++] = joint.velocity;
  return limits;
}

std::vector<std::string> RobotModel::velocity_names() const {
  const BaseKind& kind = kind_of(base.type);
  std::vector<std::string> names(kind.velocities.begin(), kind.velocities.end());
  for (const ControlledJoint& joint : joints) names.push_back(joint.name);
  return names;
}

}  // namespace moma
