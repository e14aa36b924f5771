#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/task/servo.h"

namespace moma {

/// Six rows nu - Delta <= J qdot + delta <= nu + Delta; without slack, x has no delta. Delta = 0: equalities.
void add_tracking_rows(const Matrix6X& J_WE_W, const Vector6& nu, const Vector6& band, bool slack,
                       QpProblem& problem) noexcept;

}  // namespace moma
