#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "reports/render/json.h"
#include "reports/render/report.h"

namespace moma::reports {

/// A column of trials while it is read. It holds numbers until its first text, and texts from then on.
class TrialColumn {
 public:
  void add(Json cell, bool is_text);
  /// `[NUMBER, ...]`, or of texts `{"values", "codes"}` with -1 for null.
  Json take();

 private:
  bool is_text_ = false;
  Json numbers_ = Json::array();
  Json values_ = Json::array();
  Json codes_ = Json::array();
  std::unordered_map<std::string, int> known_;
};

/// Everything the page shows, as one JSON object (reports/web/src/data.ts has its shape): rows as the queries of
/// reports/sql give them; trials by column, texts as codes into a list; infinities as "inf" and "-inf".
Json page_data(SQLite::Database& store, const ReportOptions& options);

/// The names of a page's suites, each once.
std::vector<std::string> suites_of(const Json& page);

/// Combines the pages of several stores, so that their controllers stand side by side. If each store has one suite, the
/// combined page has one; otherwise suites with the same name are joined. A controller in several stores becomes "NAME
/// (STORE)". Rows of invocations, points, summaries, trials and replays name their store. `labels`: distinct names of
/// the stores.
Json combined(std::vector<Json> pages, const std::vector<std::string>& labels);

/// Reads the stores into one page. Throws ReportError.
Json read_stores(const Stores& stores, const ReportOptions& options);

/// Adds "replays" to the page, the worst trials of each kind among the sampled trials of worlds below `worlds`, and
/// "robots", their robots by id. With `options.served` replays are names alone: the page requests their motions.
void add_replays(SQLite::Database& store, const ReportOptions& options, std::int64_t worlds, Json& page);

/// Returns one trial as the page plays it, an element of "replays" and "resolved"; empty if the store lacks the trial.
/// `trial`: its whole name. `simulate` provides samples that are not stored, the rows of the QP and the map; without
/// samples "n" is 0. Propagates exceptions of `simulate` if no samples are stored.
std::optional<Json> replay_of(SQLite::Database& store, const std::string& trial, double hz, const Simulate& simulate);

}  // namespace moma::reports
