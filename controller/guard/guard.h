#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "controller/params.h"
#include "controller/qp/pose.h"
#include "controller/situation.h"
#include "controller/step.h"

namespace moma {

struct Passes {};
/// The guard replaces the command by one within the same bounds.
struct Slowed {
  const VectorX& command;
  double kept;  ///< share of the QP's command in it, below 1
};
/// A QpTask replaces the task: the command becomes the QP's solution of it.
using Verdict = std::variant<Passes, Slowed, QpTask>;

/// Judges the QP's command before it is sent.
class Guard {
 public:
  virtual ~Guard() = default;
  /// May allocate; no other function does.
  virtual void set_objects(std::span<const ObjectShape> objects) = 0;
  /// References in the verdict are valid until the next call.
  virtual Verdict judge(const Situation& now, const Posed& posed, const VectorX& command) noexcept = 0;
};

/// Returns the guards that the parameters switch on, in the order of judgement; the first that does not pass a command
/// decides. The list of all guards is in guard.cc.
std::vector<std::unique_ptr<Guard>> make_guards(const std::shared_ptr<const RobotModel>& model,
                                                const ControllerParams& params, double control_period);

}  // namespace moma
