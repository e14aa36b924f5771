#pragma once

#include <SQLiteCpp/Database.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "controller/config/paths.h"

namespace moma::store {

/// Numbers of compared items.
struct ContentCounts {
  std::string table_hash;   ///< hash over which trials belong to which point, under which names
  std::size_t hashes = 0;   ///< texts stored under their hash: robots, controllers, suites, worlds, searches
  std::size_t copies = 0;   ///< rows of point_trial, which repeat columns of trial and world
  std::size_t samples = 0;  ///< time series that could be unpacked
  std::size_t worlds = 0;   ///< worlds whose columns repeat their JSON
  std::vector<std::string> foreign_views;  ///< views of another build that wrote to the store
};

/// Compares all redundant data of a store, and texts with their hashes; calls `finding` with a sentence for each
/// disagreement. Results that are stored once (rows of trials, timings, samples) need a replay. Cost: about 20 us per
/// world, 5 us per trial, 1 ms per 1000 samples. Throws StoreError.
ContentCounts check_contents(const fs::path& file, const std::function<void(const std::string&)>& finding);

/// Compares the texts of `schema` ("main" or an attached one) with their hashes; returns the number of texts.
std::size_t check_hashes(SQLite::Database& db, const std::string& schema,
                         const std::function<void(const std::string&)>& finding);

}  // namespace moma::store
