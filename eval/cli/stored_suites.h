#pragma once

#include <map>
#include <string>

#include "eval/store/reader.h"
#include "eval/suite/suite.h"

namespace moma::cli {

/// Suites built again from a store, each once: reading a robot takes much longer than looking up a trial.
class StoredSuites {
 public:
  /// The point that `trial` belongs to. Throws StoreError where this program simulates differently by now.
  const Point& point_of(const store::StoredTrial& trial);
  const Suite& suite_of(const store::StoredTrial& trial);

 private:
  std::map<std::string, Suite> suites_;  ///< by resolved text
};

/// Throws StoreError{kNotFound} where the trial's world could not be made, so that there is nothing to simulate.
World world_of(const store::StoredTrial& trial);

}  // namespace moma::cli
