#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

// Words that stand in columns of the store. Each column's CHECK is made from them.

namespace moma::store {

/// Of an invocation; a program that was killed leaves `running` behind, which the next one to write makes `failed`.
enum class RunStatus { kRunning, kFinished, kStopped, kFailed };
constexpr auto words(Of<RunStatus>) {
  return std::to_array<std::string_view>({"running", "finished", "stopped", "failed"});
}
static_assert(all_worded<RunStatus>());

}  // namespace moma::store
