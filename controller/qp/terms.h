#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/step.h"
#include "controller/task/servo.h"

namespace moma {

/// The terms of the objective, one file each. Every function adds its part of the diagonal of Q and of C; a term
/// whose weight is zero leaves no trace. Velocities come first in x: base (base_dof), then joints, then delta.
/// None takes memory or throws.

/// Q1's w_b I and lambda_qa, and C1's -k_eps theta_eps on the base's omega (the article's first objective).
void add_base_term(const ControllerParams& params, int base_dof, const Task& task, QpProblem& problem) noexcept;

/// C1's -lambda_m J_m on the joints; `gradient` has one value per joint.
void add_manipulability_term(const ManipulabilityParams& params, int base_dof, const VectorX& gradient,
                             QpProblem& problem) noexcept;

/// Q1's lambda_delta I on delta. With 1/||e|| or a constant; 0 leaves delta free, as the article allows.
void add_slack_term(const SlackParams& params, int num_velocities, const Task& task, QpProblem& problem) noexcept;

/// Q2 = diag(lambda_qdd, 0), C2 = -(qdot_r^T lambda_qdd, 0); qdot_r is the measured velocity.
void add_acceleration_term(const VectorX& weight, const VectorX& qdot_measured, QpProblem& problem) noexcept;

/// Q3 = diag(0, lambda_qd, 0), C3 = -(0, qd_des^T lambda_qd, 0), qd_des = k_posture (target - q).
void add_posture_term(const PostureParams& params, int base_dof, const VectorX& target, const VectorX& q,
                      QpProblem& problem) noexcept;

/// 1/||e|| or the constant.
double weight_value(const Weight& weight, const Task& task) noexcept;

}  // namespace moma
