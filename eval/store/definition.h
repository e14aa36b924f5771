#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/store/field.h"

namespace moma::store {

// The definition of the store, generated from schema.sql, views.sql and the descriptions of the records.

/// The described columns of each table, in the order of a new table. In schema.sql they replace {{columns of TABLE}}; a
/// store that lacks one gets it when it is opened for writing.
const std::vector<std::pair<std::string, std::vector<ColumnDefinition>>>& described_tables();

/// All tables and indices, but no views.
std::string tables_sql();
/// The views, each with its CREATE statement as SQLite stores it.
std::vector<std::pair<std::string, std::string>> views();
/// A query like v_summary over all families of a point together (`family` is ''), in the order of the points.
std::string query_of_overall();
/// Replaces the views.
std::string views_sql();
/// Creates temporary views that hide those of the file, which another build may have defined differently.
std::string temporary_views_sql();
/// Replaces the index that v_summary is read from.
std::string summary_index_sql();

/// "PREFIXmanip_mean, PREFIXclearance_min_m, ...": columns of trial that point_trial repeats for summaries.
std::string summary_list(const std::string& prefix = {});

/// Metrics for the report page: a JSON list of {key, of, name, unit, better, decimals or significant, head (of its
/// column of trials), summary {column, name} (in v_summary), text}; `of`: "trial", "world" or "machine" (timings).
std::string json_of_metrics();

/// The outcomes of trials, a JSON list.
std::string json_of_outcomes();

/// The words of the numbers in columns of samples, JSON: a list each for status, fallback, plan_mode, plan_reason.
std::string json_of_samples();

}  // namespace moma::store
