#include "controller/step.h"

namespace moma {

std::string_view to_string(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kSolved:
      return "solved";
    case StepStatus::kInfeasible:
      return "infeasible";
    case StepStatus::kMaxIterations:
      return "max_iterations";
    case StepStatus::kInvalidInput:
      return "invalid_input";
  }
  return "?";
}

std::string_view to_string(Fallback fallback) noexcept {
  switch (fallback) {
    case Fallback::kNone:
      return "none";
    case Fallback::kNoAcceleration:
      return "no_acceleration";
    case Fallback::kRelaxed:
      return "relaxed";
    case Fallback::kBrake:
      return "brake";
  }
  return "?";
}

}  // namespace moma
