#pragma once

#include <string>

#include "controller/case/case_file.h"
#include "controller/config/json.h"

namespace moma {

/// Runs one control step of a case and shows all of it: every matrix of the QP and its solution, as `moma solve`
/// prints it. An infeasible problem is an answer, not an error. Infinities are the strings "inf" and "-inf".
///
/// Keys: status, fallback, qdot, delta, cost (of the original objective, constants left out), pose, error [e_R; e_p],
/// error_norm (clamped, as weighed), nu, J (6 x n), manipulability, J_m, theta_eps, Q, c, A, lbA, ubA, lb, ub, rows
/// (names), distances, wheels, kkt_residual, iterations, escape and plan (the controller's memory after the step).
/// Methods without a QP have empty Q .. rows and a null residual.
///
/// kkt_residual is the largest violation of the optimality conditions (qp/problem.h) by the solution and multipliers of
/// the stage that gave the command: the original problem, or one of the fallback; null where the command brakes.
Json solve(const ControlCase& control_case);

/// The JSON as text for people and programs alike: one key to a line, one row of a matrix to a line.
std::string layout(const Json& solution);

/// The same step in words: constraints that hold the command, a minimal set of rows that make the problem infeasible,
/// the dominating term of the cost, near objects and singularities.
std::string explain(const ControlCase& control_case);

}  // namespace moma
