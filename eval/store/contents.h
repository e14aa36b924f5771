#pragma once

#include <SQLiteCpp/Database.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace moma::store {

/// Counts of what was compared.
struct ContentCounts {
  std::string
      table_hash;  ///< over what tables read besides results: which trials belong to which point, under which names
  std::size_t hashes =
      0;  ///< texts with the hash that they are kept under: robots, controllers, suites, worlds, searches
  std::size_t copies = 0;                  ///< rows of point_trial with the rows of trial and world that they repeat
  std::size_t samples = 0;                 ///< series that could be unpacked
  std::size_t worlds = 0;                  ///< columns of worlds with what the world itself says
  std::vector<std::string> foreign_views;  ///< not this build's, in a store that another build wrote to as well
};

/// Compares everything that a store says twice, and what it keeps under a hash with the hash: `finding` hears a
/// sentence for each disagreement. The values that are there once (rows of trials, their timings, samples) are for a
/// replay to judge. Cost: about 20 us a world, 5 us a trial, 1 ms a series of 1000 samples. Throws StoreError.
ContentCounts check_contents(const std::filesystem::path& file, const std::function<void(const std::string&)>& finding);

/// Compares every text that is kept under its hash with it, of `schema` ("main", or one that is attached); returns how
/// many there are. A change is told in a sentence.
std::size_t check_hashes(SQLite::Database& db, const std::string& schema,
                         const std::function<void(const std::string&)>& finding);

}  // namespace moma::store
