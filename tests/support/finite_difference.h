#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "controller/model/kinematics.h"

namespace moma::test {

/// Step that balances rounding and truncation of a central difference of a function of order 1.
inline double difference_step() { return std::cbrt(std::numeric_limits<double>::epsilon()); }

/// A base pose and joint values within the limits (continuous joints: one turn either way).
struct State {
  Vector3 base = Vector3::Zero();
  VectorX q;
};

inline State random_state(const RobotModel& model, std::mt19937& engine) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); };
  State state;
  if (model.base_dof() > 0) state.base = Vector3(uniform(-2, 2), uniform(-2, 2), uniform(-4, 4));
  state.q.resize(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(i)];
    state.q[i] = std::isfinite(joint.lower) ? uniform(joint.lower, joint.upper) : uniform(-3.14, 3.14);
  }
  return state;
}

/// Moves a state by the velocity `v` for the time 1, by many small Euler steps of the base's own motion: x' = v cos
/// phi, y' = v sin phi, phi' = omega (with v_y across for an omnidirectional base). Independent of moma::integrate().
inline State drive(const RobotModel& model, State state, const VectorX& v, int steps = 1) {
  const double dt = 1.0 / steps;
  for (int i = 0; i < steps; ++i) {
    if (model.base_dof() > 0) {
      const double omega = v[model.base_dof() - 1];
      const double across = model.base_dof() == 3 ? v[1] : 0.0;
      const double phi = state.base.z() + 0.5 * omega * dt;  // midpoint rule: second order
      state.base.x() += (v[0] * std::cos(phi) - across * std::sin(phi)) * dt;
      state.base.y() += (v[0] * std::sin(phi) + across * std::cos(phi)) * dt;
      state.base.z() += omega * dt;
    }
    state.q += dt * v.tail(model.num_joints());
  }
  return state;
}

/// Column j: (f(state driven by +h along coordinate j) - f(by -h)) / 2h. `difference(a, b)` is a "minus" b.
template <typename Function, typename Difference>
MatrixX differentiate(const RobotModel& model, const State& state, Function&& f, Difference&& difference,
                      double h = difference_step()) {
  MatrixX derivative;
  for (int j = 0; j < model.num_velocities(); ++j) {
    VectorX v = VectorX::Zero(model.num_velocities());
    v[j] = h;
    const auto plus = f(drive(model, state, v));
    const auto minus = f(drive(model, state, -v));
    const VectorX column = difference(plus, minus) / (2.0 * h);
    if (j == 0) derivative.resize(column.size(), model.num_velocities());
    derivative.col(j) = column;
  }
  return derivative;
}

/// [rotation vector; translation] that leads from b to a, in world axes.
inline VectorX pose_difference(const Isometry& a, const Isometry& b) {
  const Eigen::AngleAxisd turn(a.linear() * b.linear().transpose());
  VectorX d(6);
  d << turn.angle() * turn.axis(), a.translation() - b.translation();
  return d;
}

}  // namespace moma::test
