#pragma once

#include <vector>

#include "eval/suite/keys.h"

namespace moma::cli {

/// Every key of a suite file, those of `tune` included, in the order of the reference.
std::vector<Key> all_keys();

}  // namespace moma::cli
