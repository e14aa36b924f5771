#pragma once

#include <string>
#include <vector>

#include "controller/describe/keys.h"

namespace moma {

/// Returns every key of a suite file, in the order of the reference, except those of `tune` (eval/tune/tune_config.h)
/// and of robot files. Keys of controllers begin with `controller.`, as in --set and sweeps for all controllers of a
/// suite.
std::vector<Key> suite_keys();

/// Returns the likely intended key if `key` begins with no section of a suite ("lambda_q": "controller.lambda_q"), or
/// "". For messages.
std::string meant_key(const std::string& key);

}  // namespace moma
