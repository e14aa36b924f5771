#pragma once

#include <filesystem>
#include <stdexcept>

namespace moma::reports {

struct ReportOptions {
  int replays = 40;         ///< at most so many trials carry their motion in the page; the worst of each kind first
  double replay_hz = 10.0;  ///< samples per second of those, > 0
};

/// What is wrong with the store or the page's place; what() is complete, for a person.
class ReportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes the page of store `db` to `html`: one file that needs nothing else, neither program nor network.
/// The store is only read, in one transaction, also while a run writes to it. The page appears whole or not at
/// all (written beside its place, then renamed). A store without trials gives a page that says so.
/// Throws ReportError: no such store, not SQLite, not moma's, another schema version, no place for the page.
/// Cost: about 0.1 ms and 0.6 kB a trial, 30 kB a replay, 1.5 MB for the page's script and fonts.
void write_report(const std::filesystem::path& db, const std::filesystem::path& html,
                  const ReportOptions& options = {});

}  // namespace moma::reports

namespace moma {
using reports::ReportError;
using reports::ReportOptions;
using reports::write_report;
}  // namespace moma
