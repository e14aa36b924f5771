#include "eval/cli/all_keys.h"

#include "eval/tune/tune_config.h"

namespace moma::cli {

std::vector<Key> all_keys() {
  std::vector<Key> keys = suite_keys();
  for (Key& key : tune::tune_keys()) keys.push_back(std::move(key));
  return keys;
}

}  // namespace moma::cli
