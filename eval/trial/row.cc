#include "eval/trial/row.h"

namespace moma {

std::string_view to_string(Outcome outcome) noexcept {
  switch (outcome) {
    case Outcome::kSuccess:
      return "success";
    case Outcome::kCollision:
      return "collision";
    case Outcome::kTimeout:
      return "timeout";
    case Outcome::kStuck:
      return "stuck";
    case Outcome::kJointLimit:
      return "joint_limit";
    case Outcome::kTipped:
      return "tipped";
    case Outcome::kInfeasible:
      return "infeasible";
    case Outcome::kDiverged:
      return "diverged";
    case Outcome::kError:
      return "error";
  }
  return "?";
}

}  // namespace moma
