// A controller that is not moma's, as a plugin of the evaluation: artificial potential fields (O. Khatib, "Real-time
// obstacle avoidance for manipulators and mobile robots", Int. J. of Robotics Research 5(1), 1986). The goal attracts
// the end effector; objects push away the nearest point of every part of the robot; joint limits push back. Each
// potential is Khatib's, in a version of his scheme for robots that take velocities: the goal's force becomes a twist
// of the end effector by a damped inverse, and the others move base and joints down their gradient.

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "plugin/plugin.h"

namespace {

using namespace moma;

struct Gains {
  double attraction = 1.5;      ///< of the position [1/s]
  double turning = 1.95;        ///< of the orientation [1/s]
  double max_linear = 0.6;      ///< Khatib's V_max [m/s]
  double max_angular = 1.0;     ///< [rad/s]
  double repulsion = 2e-3;      ///< eta
  double influence = 0.3;       ///< rho_0 [m]
  double self_influence = 0.1;  ///< of the robot's own parts on each other [m]
  double limit_repulsion = 1e-3;
  double limit_influence = 0.2;  ///< [rad, m]
  double base_mobility = 1.0;    ///< how far the base gives way, against 1 of the joints
  double damping = 0.05;
};

// eta (1/rho - 1/rho_0) / rho^2 inside rho_0: the slope of 1/2 eta (1/rho - 1/rho_0)^2. It has no value in contact.
double push(double rho, double rho_0, double eta) {
  constexpr double kLeast = 0.01;
  const double r = std::max(rho, kLeast);
  return r < rho_0 ? eta * (1.0 / r - 1.0 / rho_0) / (r * r) : 0.0;
}

Vector3 shortened(const Vector3& v, double longest) { return v.norm() > longest ? longest / v.norm() * v : v; }

class PotentialField {
 public:
  PotentialField(std::shared_ptr<const RobotModel> robot, const Gains& gains, double control_period)
      : robot_(std::move(robot)),
        gains_(gains),
        period_(control_period),
        kinematics_(robot_),
        proximity_(robot_),
        mobility_(VectorX::Ones(robot_->num_velocities())),
        force_(VectorX::Zero(robot_->num_velocities())),
        J_p_(3, robot_->num_velocities()) {
    mobility_.head(robot_->base_dof()).setConstant(gains.base_mobility);
  }

  void reset(std::span<const ObjectShape> objects) { proximity_.set_objects(objects); }
  void prepare(StepResult& result) const { result.command = VectorX::Zero(robot_->num_velocities()); }

  void step(const Observation& seen, StepResult& result) {
    kinematics_.update(seen.base, seen.q);
    force_.setZero();
    result.least_distance = kInfinity;
    const ProximityRanges ranges{gains_.influence, -1.0, gains_.self_influence};
    for (const ProximityPair& pair : proximity_.query(kinematics_, seen.objects, ranges)) {
      const Distance& d = pair.distance;
      const bool self = pair.kind == PairKind::kSelf;
      const double size = push(d.d, self ? gains_.self_influence : gains_.influence, gains_.repulsion);
      pull(pair.first, d.p_first_W, size * d.n_W);
      if (self) pull(pair.second, d.p_second_W, -size * d.n_W);
      if (!self) result.least_distance = std::min(result.least_distance, d.d);
    }
    for (int i = 0; i < robot_->num_joints(); ++i) {
      const ControlledJoint& joint = robot_->joints[static_cast<std::size_t>(i)];
      force_[robot_->base_dof() + i] += push(seen.q[i] - joint.lower, gains_.limit_influence, gains_.limit_repulsion) -
                                        push(joint.upper - seen.q[i], gains_.limit_influence, gains_.limit_repulsion);
    }

    Vector6 twist;
    const Matrix3 turn = seen.goal.X_WG.linear() * kinematics_.X_WE().linear().transpose();
    twist << shortened(gains_.turning * log_so3(turn), gains_.max_angular),
        shortened(gains_.attraction * (seen.goal.X_WG.translation() - kinematics_.X_WE().translation()),
                  gains_.max_linear);
    const Matrix6X& J = kinematics_.J_WE_W();
    const Matrix6X weighted = J * mobility_.asDiagonal();
    const Eigen::Matrix<double, 6, 6> inner =
        weighted * J.transpose() + gains_.damping * gains_.damping * Eigen::Matrix<double, 6, 6>::Identity();
    result.command = weighted.transpose() * inner.ldlt().solve(twist) + mobility_.cwiseProduct(force_);
    stop_at_limits(seen.q, result.command);
  }

 private:
  // Maps a force at a point of a shape to base and joints.
  void pull(int shape, const Vector3& p_W, const Vector3& force) {
    kinematics_.point_jacobian(robot_->shapes[static_cast<std::size_t>(shape)].link, p_W, J_p_);
    force_ += J_p_.transpose() * force;
  }

  // A potential is no wall for a step of finite length.
  void stop_at_limits(const VectorX& q, VectorX& command) const {
    for (int i = 0; i < robot_->num_joints(); ++i) {
      const ControlledJoint& joint = robot_->joints[static_cast<std::size_t>(i)];
      double& v = command[robot_->base_dof() + i];
      v = std::clamp(v, std::min((joint.lower - q[i]) / period_, 0.0), std::max((joint.upper - q[i]) / period_, 0.0));
    }
  }

  std::shared_ptr<const RobotModel> robot_;
  Gains gains_;
  double period_;
  Kinematics kinematics_;
  Proximity proximity_;
  VectorX mobility_, force_;
  Matrix3X J_p_;
};

std::unique_ptr<PotentialField> make(const plugin::Setup& setup) {
  Gains g;
  config::MapReader in(setup.parameters, "parameters");
  using config::Range;
  in.read("attraction", g.attraction, Range::non_negative());
  in.read("turning", g.turning, Range::non_negative());
  in.read("max_linear", g.max_linear, Range::positive());
  in.read("max_angular", g.max_angular, Range::positive());
  in.read("repulsion", g.repulsion, Range::non_negative());
  in.read("influence", g.influence, Range::positive());
  in.read("self_influence", g.self_influence, Range::positive());
  in.read("limit_repulsion", g.limit_repulsion, Range::non_negative());
  in.read("limit_influence", g.limit_influence, Range::positive());
  in.read("base_mobility", g.base_mobility, Range::non_negative());
  in.read("damping", g.damping, Range::positive());
  in.finish();
  return std::make_unique<PotentialField>(setup.robot, g, setup.control_period);
}

}  // namespace

MOMA_PLUGIN(make)
