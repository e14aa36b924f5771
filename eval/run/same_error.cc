#include "eval/run/same_error.h"

namespace moma::run {

void SameError::look(std::size_t point, const TrialRow& row) {
  if (working_.count(point) > 0) return;
  const auto [at, fresh] = failing_.try_emplace(point, Found{point, 0, row.reason});
  if (row.outcome != Outcome::kError || row.reason != at->second.reason) {
    failing_.erase(at);
    working_.insert(point);
    return;
  }
  ++at->second.trials;
}

const SameError::Found* SameError::found() const {
  const Found* most = nullptr;
  for (const auto& [point, found] : failing_)
    if (most == nullptr || found.trials > most->trials) most = &found;
  return most;
}

}  // namespace moma::run
