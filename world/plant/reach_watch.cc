#include "world/plant/reach_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/model/kinematics.h"

namespace moma {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kBeyond = 0.01;  // tolerance of linear joints' limits [m]
constexpr Eigen::Index kOfBase = 0, kOfTurn = 1, kOfJoints = 2;

/// Levers of the base's turn and of each joint for the points of one shape; 0 without effect. Walks from the shape to
/// the base with a ball that contains the shape, seen from each link, for any position of the joints passed.
VectorX levers_of(const CollisionShape& shape, const Kinematics& kinematics) {
  const RobotModel& model = kinematics.model();
  VectorX levers = VectorX::Zero(kOfJoints + model.num_joints());
  Vector3 centre = shape.X_LS.translation();
  double radius = bounding_radius(shape.shape);
  for (int i = shape.link; i > 0; i = model.links[static_cast<std::size_t>(i)].parent) {
    const Link& link = model.links[static_cast<std::size_t>(i)];
    if (link.controlled < 0) {
      centre = kinematics.X_WL(link.parent).inverse() * (kinematics.X_WL(i) * centre);
      continue;
    }
    double& lever = levers[kOfJoints + link.controlled];
    if (link.joint_type == JointType::kPrismatic) {
      const ControlledJoint& joint = model.joints[static_cast<std::size_t>(link.controlled)];
      lever = 1.0;
      centre += 0.5 * (joint.lower + joint.upper) * link.axis;
      radius += 0.5 * (joint.upper - joint.lower) + kBeyond;
    } else {
      const Vector3 on_axis = link.axis * link.axis.dot(centre);
      lever = (centre - on_axis).norm() + radius;
      centre = on_axis;
      radius = lever;
    }
    centre = link.X_PJ * centre;
  }
  if (model.mobile()) {
    levers[kOfBase] = 1.0;
    levers[kOfTurn] = centre.head<2>().norm() + radius;
  }
  return levers;
}

}  // namespace

ReachWatch::ReachWatch(const std::shared_ptr<const RobotModel>& shared, const std::vector<SolidPair>& pairs,
                       std::size_t objects)
    : lower_(shared->num_joints()),
      upper_(shared->num_joints()),
      moves_(VectorX::Zero(kOfJoints + shared->num_joints())) {
  const RobotModel& model = *shared;
  for (int j = 0; j < model.num_joints(); ++j) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(j)];
    lower_[j] = joint.lower - kBeyond;
    upper_[j] = joint.upper + kBeyond;
    if (joint.type == JointType::kPrismatic) linear_.push_back(j);
  }
  const auto n = static_cast<Eigen::Index>(model.shapes.size());
  const auto self =
      std::count_if(pairs.begin(), pairs.end(), [](const SolidPair& pair) { return pair.kind == PairKind::kSelf; });
  levers_ = MatrixX::Zero(2 * n + self, moves_.size());
  const Kinematics kinematics(shared);
  for (Eigen::Index i = 0; i < n; ++i) {
    levers_.row(i) = levers_of(model.shapes[static_cast<std::size_t>(i)], kinematics);
    levers_.row(n + i).tail(model.num_joints()) = levers_.row(i).tail(model.num_joints());
  }
  const auto first_object = static_cast<std::size_t>(levers_.rows());
  const std::size_t zero = first_object + objects;
  Eigen::Index row = 2 * n;
  for (const SolidPair& pair : pairs) {
    Watched watched{pair, static_cast<std::size_t>(pair.first), zero, 0.0};
    switch (pair.kind) {
      case PairKind::kObject:
        watched.way_second = first_object + static_cast<std::size_t>(pair.second);
        break;
      case PairKind::kFloor:
        watched.way_first += static_cast<std::size_t>(n);
        break;
      case PairKind::kSelf:
        watched.way_first = static_cast<std::size_t>(row);
        for (Eigen::Index j = kOfJoints; j < levers_.cols(); ++j) {
          const double a = levers_(pair.first, j), b = levers_(pair.second, j);
          // A motion that carries both moves neither against the other.
          levers_(row, j) = a > 0.0 && b > 0.0 ? 0.0 : a + b;
        }
        ++row;
        break;
    }
    pairs_.push_back(watched);
  }
  near_.reserve(pairs_.size());
  way_ = VectorX::Zero(static_cast<Eigen::Index>(zero) + 1);
  step_ = way_;
  forget();
}

ReachWatch::Travel ReachWatch::rest() const {
  Travel travel;
  travel.joints = VectorX::Zero(lower_.size());
  travel.objects = VectorX::Zero(way_.size() - 1 - levers_.rows());
  return travel;
}

void ReachWatch::between(const Vector3& base_0, const VectorX& q_0, const Vector3& base_1, const VectorX& q_1,
                         Travel& travel) const {
  travel.base = (base_1 - base_0).head<2>().norm();
  travel.turn = std::abs(base_1.z() - base_0.z());
  travel.joints = (q_1 - q_0).cwiseAbs();
  const auto inside = [this](const VectorX& q, int j) { return q[j] >= lower_[j] && q[j] <= upper_[j]; };
  for (const int j : linear_)
    if (!inside(q_0, j) || !inside(q_1, j)) travel.joints[j] = kInfinite;
}

void ReachWatch::begin(const Travel& travel) {
  moves_[kOfBase] = travel.base;
  moves_[kOfTurn] = travel.turn;
  moves_.tail(travel.joints.size()) = travel.joints;
  step_.head(levers_.rows()).noalias() = levers_ * moves_;
  step_.segment(levers_.rows(), travel.objects.size()) = travel.objects;
}

void ReachWatch::end() {
  way_ += step_;
  step_.setZero();
  if (!way_.allFinite()) forget();
}

void ReachWatch::forget() {
  way_.setZero();
  for (Watched& watched : pairs_) watched.until = -kInfinite;
}

}  // namespace moma
