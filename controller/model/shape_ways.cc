#include "controller/model/shape_ways.h"

#include <algorithm>

namespace moma {

ShapeWays::ShapeWays(const RobotModel& model)
    : model_(&model),
      base_dof_(model.base_dof()),
      most_(model.shapes.size(), 0.0),
      centres_W_(model.shapes.size(), Vector3::Zero()),
      levers_at_first_(Rows::Zero(static_cast<Eigen::Index>(model.shapes.size()), model.num_velocities())),
      levers_(levers_at_first_) {
  for (const CollisionShape& shape : model.shapes) {
    radii_.push_back(bounding_radius(shape.shape));
    // Controlled joints form one chain, in its order: the last joint that carries the shape identifies all others.
    int joints = 0;
    for (int i = shape.link; i > 0; i = model.link(i).parent) joints = std::max(joints, model.link(i).controlled + 1);
    moved_by_.push_back(joints);
  }
}

void ShapeWays::begin(const Kinematics& kinematics) noexcept {
  const std::size_t count = model_->shapes.size();
  if (model_->spare) radii_.back() = bounding_radius(model_->shapes.back().shape);
  for (std::size_t s = 0; s < count; ++s) {
    const CollisionShape& shape = model_->shapes[s];
    centres_W_[s] = kinematics.X_WL(shape.link) * shape.X_LS.translation();
    if (base_dof_ == 0) continue;
    const auto row = static_cast<Eigen::Index>(s);
    levers_at_first_.row(row).head(base_dof_ - 1).setOnes();
    levers_at_first_(row, base_dof_ - 1) =
        (centres_W_[s] - kinematics.X_WB().translation()).head<2>().norm() + radii_[s];
  }
  for (int j = 0; j < model_->num_joints(); ++j) {
    const Link& link = model_->link(model_->joint(j).link);
    const Isometry& X_WJ = kinematics.X_WL(model_->joint(j).link);
    const Vector3 axis_W = X_WJ.linear() * link.axis, origin_W = X_WJ.translation();
    const bool prismatic = link.joint_type == JointType::kPrismatic;
    for (std::size_t s = 0; s < count; ++s) {
      if (moved_by_[s] <= j) continue;
      levers_at_first_(static_cast<Eigen::Index>(s), base_dof_ + j) =
          prismatic ? 1.0 : axis_W.cross(centres_W_[s] - origin_W).norm() + radii_[s];
    }
  }
  levers_ = levers_at_first_;
  std::fill(most_.begin(), most_.end(), 0.0);
}

void ShapeWays::limit(const VectorX& most) noexcept {
  for (std::size_t s = 0; s < most_.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    double way = 0.0;
    for (int j = moved_by_[s] - 1; j >= 0; --j) {
      const bool prismatic = model_->joint(j).type == JointType::kPrismatic;
      const Eigen::Index k = base_dof_ + j;
      levers_(row, k) = levers_at_first_(row, k) + (prismatic ? 0.0 : way);
      way += levers_(row, k) * most[k];
    }
    if (base_dof_ > 0) {
      const Eigen::Index turn = base_dof_ - 1;
      levers_(row, turn) = levers_at_first_(row, turn) + way;
      way += levers_(row, turn) * most[turn];
      for (Eigen::Index k = 0; k < turn; ++k) way += most[k];
    }
    most_[s] = way;
  }
}

// Travel by the joints from `first_joint` on.
double ShapeWays::by_joints(int shape, int first_joint, const VectorX& gone) const noexcept {
  double way = 0.0;
  const int end = base_dof_ + moved_by_[static_cast<std::size_t>(shape)];
  for (int k = base_dof_ + first_joint; k < end; ++k) way += levers_(shape, k) * gone[k];
  return way;
}

double ShapeWays::in_world(int shape, const VectorX& gone) const noexcept {
  double way = by_joints(shape, 0, gone);
  for (int k = 0; k < base_dof_; ++k) way += levers_(shape, k) * gone[k];
  return way;
}

double ShapeWays::in_height(int shape, const VectorX& gone) const noexcept { return by_joints(shape, 0, gone); }

double ShapeWays::between(int first, int second, const VectorX& gone) const noexcept {
  const int a = moved_by_[static_cast<std::size_t>(first)], b = moved_by_[static_cast<std::size_t>(second)];
  return a < b ? by_joints(second, a, gone) : by_joints(first, b, gone);
}

}  // namespace moma
