#pragma once

#include "eval/trial/row.h"
#include "plugin/host/plugin.h"

namespace moma {

/// True if a trial ended because real time ran out. Such a row is not stored, and the trial is tried again.
inline bool is_late(const TrialRow& row) noexcept { return row.outcome == Outcome::kError && is_late(row.reason); }

}  // namespace moma
