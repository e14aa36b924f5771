#pragma once

#include <string>
#include <vector>

#include "controller/describe/keys.h"

namespace moma {

/// Every key of a suite file but those of `tune` (eval/tune/tune_config.h) and those inside robot files, in the order
/// of the reference. Keys of controllers stand under `controller.`, as --set and sweeps take them for all of a suite's.
std::vector<Key> suite_keys();

/// Where `key` begins with no section of a suite: the key that is likely meant ("lambda_q": "controller.lambda_q"),
/// or "". For messages.
std::string meant_key(const std::string& key);

}  // namespace moma
