#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "files/output_file.h"
#include "reports/render/evidence.h"
#include "reports/render/mesh_data.h"
#include "reports/render/replay_data.h"

namespace moma::reports {

/// A trial needs what is not here: a plugin that is refused, a file that its suite names. The page shows what is
/// stored.
class CannotSimulate : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Simulates a trial again: its samples, the rows of its QP and its map; nothing where it has no samples.
/// Throws CannotSimulate where that cannot be done here.
using Simulate =
    std::function<std::optional<OwnedSamples>(const std::filesystem::path& store, const std::string& trial)>;

struct ReportOptions {
  /// Largest number of trials that the page holds one by one: those of each point's first worlds. Rates, intervals,
  /// medians and means of the table of results cover all trials.
  std::int64_t trials = 50000;
  int replays = 40;         ///< at most so many trials carry their motion in the page; the worst of each kind first
  double replay_hz = 10.0;  ///< samples per second of those, > 0
  std::chrono::milliseconds patience{600000};  ///< for reading one store, whose views could be without end
  bool served = false;   ///< for a page that asks `moma view` for motions: trials are named, their motion left out
  TimeKnown time_known;  ///< for causes of collisions; without it they are not looked for
  int twins = 12;  ///< of so many failures with motion the page has a success in the same world too, to play beside it
  std::string notes;  ///< of the page's author, Markdown, for its head
  Look look;          ///< what robots look like; without it they are shown as the shapes that count in collisions
  Simulate simulate;  ///< for rows, maps, and trials without samples; without it they are left out
  files::Replace replace = files::Replace::kOwn;  ///< what may stand where the page goes
};

using Stores = std::vector<std::filesystem::path>;

/// An error of the store or of the page's place; what() is a complete message.
class ReportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every page, also of earlier versions, has its mark in its title.
const files::Kind& page_kind();

/// Writes the page of one store, or of several side by side, to `html`: one file that needs nothing else, neither
/// program nor network. Each store is only read, in one transaction, also while a run writes to it. The page appears
/// whole or not at all (written beside its place, then renamed). A store without trials gives a page that says so.
/// Throws ReportError: no such store, not SQLite, not moma's, another schema version, no place for the page, or a
/// file in that place which is no such page.
/// Cost: about 0.1 ms and 0.6 kB a trial, 30 kB a replay, 1.5 MB for the page's script and fonts.
void write_report(const Stores& stores, const std::filesystem::path& html, const ReportOptions& options = {});

/// Shows a page in the reader's own browser, as $BROWSER or else xdg-open names it, and waits until that has started
/// it. False where there is none, or it fails.
bool open_in_browser(const std::filesystem::path& html);

}  // namespace moma::reports
