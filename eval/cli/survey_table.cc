#include "eval/cli/survey_table.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "eval/cli/table.h"

namespace moma::cli {
namespace {

using store::Cell;

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

Cell whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

}  // namespace

void print_survey(std::ostream& out, const run::WorldSurvey& survey, bool times) {
  if (survey.tallies().empty()) return;
  store::QueryResult made{{"robot", "family", "worlds", "tries each"}, {}};
  if (times) made.columns.insert(made.columns.end(), {"us each", "trials", "ms a trial", "% of a trial"});
  store::QueryResult reasons{{"robot", "family", "rejected", "of %", "because"}, {}};
  for (const auto& [place, tally] : survey.tallies()) {
    const auto& [robot, family] = place;
    const auto worlds = static_cast<double>(std::max<std::uint64_t>(1, tally.log.worlds));
    made.rows.push_back(
        {robot, family, whole(tally.log.worlds), rounded(static_cast<double>(tally.log.tries) / worlds, 0.1)});
    if (times) {
      const double each = tally.seconds / worlds;
      std::vector<Cell>& row = made.rows.back();
      row.emplace_back(rounded(1e6 * each, 1.0));
      row.push_back(whole(tally.trials));
      if (tally.trials > 0) {
        const double trial = tally.trial_seconds / static_cast<double>(tally.trials);
        row.emplace_back(rounded(1e3 * trial, 0.1));
        row.emplace_back(rounded(100.0 * each / trial, 0.01));
      } else {
        row.resize(row.size() + 2);
      }
    }
    // Most frequent first, those of equal count by name.
    std::vector<std::pair<std::string, std::uint64_t>> sorted(tally.log.rejections.begin(), tally.log.rejections.end());
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    for (const auto& [why, count] : sorted)
      reasons.rows.push_back({robot, family, whole(count),
                              rounded(100.0 * static_cast<double>(count) / static_cast<double>(tally.log.tries), 0.1),
                              why});
    for (const auto& [why, count] : tally.log.redraws)
      reasons.rows.push_back({robot, family, whole(count), Cell{}, why + " (drawn again)"});
  }
  std::set<std::string> robots;
  for (const auto& [place, tally] : survey.tallies()) robots.insert(place.first);
  if (robots.size() == 1) {  // the line above names it
    for (store::QueryResult* table : {&made, &reasons}) {
      table->columns.erase(table->columns.begin());
      for (std::vector<Cell>& row : table->rows) row.erase(row.begin());
    }
  }
  write(out, made, Format::kTable);
  if (!reasons.rows.empty()) {
    out << '\n';
    write(out, reasons, Format::kTable);
  }
  out << '\n';
}

}  // namespace moma::cli
