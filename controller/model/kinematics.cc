#include "controller/model/kinematics.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "controller/model/base_kind.h"

namespace moma {
namespace {

// X * the joint's motion, without factors that are identities.
void move(const Link& link, double value, Isometry& X) noexcept {
  if (link.joint_type == JointType::kPrismatic) {
    X.translation() += X.linear() * (value * link.axis);
  } else if (link.joint_type != JointType::kFixed) {
    X.linear() *= Eigen::AngleAxisd(value, link.axis).toRotationMatrix();
  }
}

// sin(x)/x, accurate everywhere.
double sinc(double x) noexcept { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

}  // namespace

Kinematics::Kinematics(std::shared_ptr<const RobotModel> model)
    : model_(std::move(model)),
      q_(model_->ready),
      X_PL_(model_->links.size(), Isometry::Identity()),
      X_WL_(model_->links.size(), Isometry::Identity()),
      J_WE_W_(Matrix6X::Zero(6, model_->num_velocities())) {
  for (std::size_t i = 0; i < X_PL_.size(); ++i) {
    const Link& link = model_->links[i];
    X_PL_[i] = link.X_PJ;
    if (link.controlled < 0) move(link, link.held, X_PL_[i]);
  }
  update(base_, q_);
}

void Kinematics::place(const Vector3& base, const Eigen::Ref<const VectorX>& q) noexcept {
  base_ = base;
  q_ = q;
  X_WL_[0] = base_pose(base);
  for (std::size_t i = 1; i < X_WL_.size(); ++i) {
    const Link& link = model_->links[i];
    const Isometry& X_WP = X_WL_[static_cast<std::size_t>(link.parent)];
    X_WL_[i] = X_WP * X_PL_[i];
    if (link.controlled >= 0) move(link, q_[link.controlled], X_WL_[i]);
  }
}

void Kinematics::update(const Vector3& base, const Eigen::Ref<const VectorX>& q) noexcept {
  place(base, q);
  X_WE_ = X_WL(model_->tip) * model_->X_TE;

  const Vector3 p_E = X_WE_.translation();
  point_jacobian(model_->tip, p_E, J_WE_W_.bottomRows<3>());
  J_WE_W_.topRows<3>().setZero();
  const int base_dof = model_->base_dof();
  if (base_dof > 0) J_WE_W_(2, base_dof - 1) = 1.0;
  for (int i = model_->tip; i > 0; i = model_->link(i).parent) {
    const Link& link = model_->link(i);
    if (link.controlled >= 0 && link.joint_type != JointType::kPrismatic)
      J_WE_W_.col(base_dof + link.controlled).head<3>() = X_WL(i).linear() * link.axis;
  }
}

void Kinematics::point_jacobian(int link, const Vector3& p_W, Eigen::Ref<Matrix3X> out) const noexcept {
  out.setZero();
  const int base_dof = model_->base_dof();
  if (base_dof > 0) {
    const Matrix3 R_WB = X_WB().linear();
    out.col(0) = R_WB.col(0);
    if (kind_of(model_->base.type).lateral()) out.col(1) = R_WB.col(1);
    const Vector3 r = p_W - X_WB().translation();
    out.col(base_dof - 1) = Vector3(-r.y(), r.x(), 0.0);
  }
  for (int i = link; i > 0; i = model_->link(i).parent) {
    const Link& moved = model_->link(i);
    if (moved.controlled < 0) continue;
    const Isometry& X = X_WL(i);
    const Vector3 axis_W = X.linear() * moved.axis;
    if (moved.joint_type == JointType::kPrismatic) {
      out.col(base_dof + moved.controlled) = axis_W;
    } else {
      out.col(base_dof + moved.controlled) = axis_W.cross(p_W - X.translation());
    }
  }
}

void free_jacobian(const Kinematics& kinematics, Eigen::Ref<Matrix6X> J) noexcept {
  const Eigen::Index joints = J.cols() - 3;
  const Vector3 r = kinematics.X_WE().translation() - kinematics.X_WB().translation();
  J.leftCols<3>().setZero();
  J(3, 0) = J(4, 1) = J(2, 2) = 1.0;
  J(3, 2) = -r.y();
  J(4, 2) = r.x();
  J.rightCols(joints) = kinematics.J_WE_W().rightCols(joints);
}

void integrate(const RobotModel& model, Vector3& base, Eigen::Ref<VectorX> q, const Eigen::Ref<const VectorX>& v,
               double dt) noexcept {
  if (model.base_dof() > 0) {
    // Constant (v_x, v_y, omega) in B for dt: p += R(phi) V(theta) (v_x, v_y) dt with theta = omega dt and
    // V = [sin/theta, -(1-cos)/theta; (1-cos)/theta, sin/theta] (Lynch & Park 2017, 3.88, in the plane).
    const Vector3 velocity_B = kind_of(model.base.type).velocity_B(v);
    const double theta = velocity_B.z() * dt;
    const double along = sinc(theta);
    const double across = sinc(0.5 * theta) * std::sin(0.5 * theta);
    const Vector2 u = velocity_B.head<2>() * dt;
    const Vector2 d(along * u.x() - across * u.y(), across * u.x() + along * u.y());
    const double c = std::cos(base.z());
    const double s = std::sin(base.z());
    base += Vector3(c * d.x() - s * d.y(), s * d.x() + c * d.y(), theta);
  }
  q += dt * v.tail(q.size());
}

Vector3 log_so3(const Matrix3& R) noexcept {
  // Through the quaternion: its conversion picks the largest component, and is accurate at 0 and at pi.
  const Eigen::Quaterniond quaternion(R);
  Vector3 v = quaternion.vec();
  double w = quaternion.w();
  if (w < 0.0) {
    v = -v;
    w = -w;
  }
  if (w < 1e-14) {  // angle pi up to rounding: both directions are valid
    for (int i = 0; i < 3; ++i) {
      if (std::abs(v[i]) < 1e-12) continue;
      if (v[i] < 0.0) v = -v;
      break;
    }
  }
  const double n = v.norm();
  return n < 1e-8 ? Vector3(2.0 / w * v) : Vector3(2.0 * std::atan2(n, w) / n * v);
}

Vector6 pose_error(const Isometry& X_WE, const Isometry& X_WG) noexcept {
  Vector6 e;
  e.head<3>() = log_so3(X_WG.linear() * X_WE.linear().transpose());
  e.tail<3>() = X_WG.translation() - X_WE.translation();
  return e;
}

Isometry nearest_pose(const Isometry& X_WG, const Vector6& free, const Isometry& X_WE) noexcept {
  if (free.isZero(0.0)) return X_WG;
  const Matrix3 R_WG = X_WG.linear();
  Isometry X = X_WG;
  X.translation() += R_WG * (free.tail<3>().array() != 0.0)
                                .select(R_WG.transpose() * (X_WE.translation() - X.translation()), Vector3::Zero());
  const Eigen::Array<bool, 3, 1> turns = free.head<3>().array() != 0.0;
  const auto count = turns.count();
  if (count == 3) X.linear() = X_WE.linear();
  if (count == 0 || count == 3) return X;
  Eigen::Index axis = 0;  // the only free one, or the only one that is not
  while (turns[axis] != (count == 1)) ++axis;
  const Eigen::Quaterniond q_GE(Matrix3(R_WG.transpose() * X_WE.linear()));
  const double angle = 2.0 * std::atan2(q_GE.vec()[axis], q_GE.w());
  const Matrix3 twist = Eigen::AngleAxisd(angle, Vector3::Unit(axis)).toRotationMatrix();
  X.linear() = count == 1 ? Matrix3(R_WG * twist) : Matrix3(X_WE.linear() * twist.transpose());
  return X;
}

double wrapped(double angle) noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double size = std::abs(angle);
  if (size <= std::numbers::pi) return angle;
  // The difference is exact (Sterbenz), as std::remainder() is, which takes ten times as long.
  if (size < 1.4 * kTurn) return std::copysign(1.0, angle) * (size - kTurn);
  return std::remainder(angle, kTurn);
}

Vector3 rpy_of(const Matrix3& R) noexcept {
  const double level = std::hypot(R(0, 0), R(1, 0)), pitch = std::atan2(-R(2, 0), level);
  if (level < 1e-9) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Isometry base_pose(const Vector3& base) noexcept {
  Isometry X = Isometry::Identity();
  const double c = std::cos(base.z());
  const double s = std::sin(base.z());
  X.linear() << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  X.translation() << base.x(), base.y(), 0.0;
  return X;
}

}  // namespace moma
