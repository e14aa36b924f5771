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

/// Command of a policy that solves no QP. Guards do not see it.
struct DirectCommand {
  const VectorX& velocities;
  StepStatus status = StepStatus::kSolved;  ///< other than kSolved: the velocities are zero
};

/// Output of a policy: a task for the QP, or a command.
using Demand = std::variant<QpTask, DirectCommand>;

/// Decides what one step asks of the robot.
class Policy {
 public:
  virtual ~Policy() = default;
  /// Takes no memory. References in the demand hold until the next call.
  virtual Demand decide(const Situation& now) noexcept = 0;
  /// Runs after the command is sent: work that is spread over steps. Takes no memory.
  virtual void finish(const Situation& /*now*/) noexcept {}
};

/// What policies are made of. All of it outlives them. `escape` and `lookahead` hold what is remembered between steps.
struct PolicyParts {
  std::shared_ptr<const RobotModel> model;
  const ControllerParams& params;
  QpPoser& poser;
  Escape& escape;
  Lookahead* lookahead;  ///< null where `plan` is off
};

/// The policy that the parameters name; the list of all policies is in policy.cc.
std::unique_ptr<Policy> make_policy(const PolicyParts& parts);

}  // namespace moma
