#pragma once

#include <memory>
#include <variant>

#include "controller/params.h"
#include "controller/qp/pose.h"
#include "controller/situation.h"
#include "controller/step.h"

namespace moma {

class Escape;
class Lookahead;

/// Command of a policy that solves no QP. Guards do not check it.
struct DirectCommand {
  const VectorX& velocities;
  StepStatus status = StepStatus::kSolved;  ///< other than kSolved: the velocities are zero
};

/// Output of a policy: a task for the QP, or a command.
using Demand = std::variant<QpTask, DirectCommand>;

/// Decides the task or command of one step.
class Policy {
 public:
  virtual ~Policy() = default;
  /// Does not allocate. References in the demand are valid until the next call.
  virtual Demand decide(const Situation& now) noexcept = 0;
  /// Runs after the command is sent, for work that is spread over steps. Does not allocate.
  virtual void finish(const Situation& /*now*/) noexcept {}
};

/// Parts of policies, which must outlive them. `escape` and `lookahead` hold the memory between steps.
struct PolicyParts {
  std::shared_ptr<const RobotModel> model;
  const ControllerParams& params;
  QpPoser& poser;
  Escape& escape;
  Lookahead* lookahead;  ///< null if `plan` is off
};

/// Makes the policy of the parameters; the list of all policies is in policy.cc.
std::unique_ptr<Policy> make_policy(const PolicyParts& parts);

}  // namespace moma
