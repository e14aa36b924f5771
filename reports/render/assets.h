#pragma once

#include <string_view>

namespace moma::reports {

/// Files that are part of the program: the page's bundle and the queries of reports/sql.
std::string_view page_js() noexcept;
std::string_view page_css() noexcept;
std::string_view extent_sql() noexcept;
std::string_view trials_sql() noexcept;
std::string_view summary_sql() noexcept;
std::string_view overall_sql() noexcept;
std::string_view points_sql() noexcept;
std::string_view invocations_sql() noexcept;
std::string_view replays_sql() noexcept;
std::string_view replay_sql() noexcept;
std::string_view twin_sql() noexcept;
std::string_view evidence_sql() noexcept;
std::string_view figures_js() noexcept;
/// What the store says of each metric, as JSON.
std::string_view metrics_json() noexcept;
/// The words for how a trial ends, a JSON list.
std::string_view outcomes_json() noexcept;
std::string_view tuning_sql() noexcept;
std::string_view tuning_variables_sql() noexcept;
std::string_view tuning_evaluations_sql() noexcept;
std::string_view tuning_sensitivity_sql() noexcept;
std::string_view tuning_comparisons_sql() noexcept;

}  // namespace moma::reports
