#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "reports/render/report.h"

namespace moma::reports {

/// A column of trials while it is read: of numbers, or from its first text on of texts.
class TrialColumn {
 public:
  void add(nlohmann::ordered_json cell, bool is_text);
  /// `[NUMBER, ...]`, or of texts `{"values", "codes"}` with -1 for null.
  nlohmann::ordered_json take();

 private:
  bool is_text_ = false;
  nlohmann::ordered_json numbers_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json values_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json codes_ = nlohmann::ordered_json::array();
  std::unordered_map<std::string, int> known_;
};

/// Everything the page shows, as one JSON object (reports/web/src/data.ts has its shape): rows as the queries of
/// reports/sql give them; trials by column, texts as codes into a list; infinities as "inf" and "-inf".
nlohmann::ordered_json page_data(SQLite::Database& store, const ReportOptions& options);

/// The same of several stores, so that their controllers stand side by side. Where each store holds one suite, all
/// trials are shown as one; else equal names of suites are the same suite. A controller that several stores hold
/// under one name is called "NAME (STORE)". Rows of invocations, points, summaries, trials and replays tell their
/// store. `labels` are the stores' distinct names.
nlohmann::ordered_json combined(std::vector<nlohmann::ordered_json> pages, const std::vector<std::string>& labels);

/// Opens and reads the stores; several are combined. Throws ReportError.
nlohmann::ordered_json read_stores(const Stores& stores, const ReportOptions& options);

/// Adds to the page "replays", the worst trials of each kind among those with samples of worlds before `worlds`, and
/// "robots", each robot that one of them needs, by its id. With `options.served` the trials are named only: their
/// motion is asked for later.
void add_replays(SQLite::Database& store, const ReportOptions& options, std::int64_t worlds,
                 nlohmann::ordered_json& page);

/// One trial as the page plays it, with its robot: an element of "replays" and "resolved". `trial` is its whole
/// name; nothing where the store has no such trial. `simulate` stands in for samples that the store does not hold, and
/// gives the rows of the QP; without samples "n" is 0. Throws what `simulate` throws, unless samples are stored.
std::optional<nlohmann::ordered_json> replay_of(SQLite::Database& store, const std::string& trial, double hz,
                                                const Simulate& simulate);

}  // namespace moma::reports
