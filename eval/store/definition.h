#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/store/field.h"

namespace moma::store {

// What the store looks like, made of schema.sql and views.sql and of the descriptions of what it keeps: columns and
// words are not written down a second time.

/// The described columns of each table that has any, by the table's name. A record that is named here has its columns
/// in schema.sql by {{columns of TABLE}}, and a store that lacks one of them gets it when it is opened for writing.
const std::vector<std::pair<std::string, std::vector<ColumnDefinition>>>& described_tables();

/// All tables and indices, but no views.
std::string tables_sql();
/// The views, each with the statement that makes it, as SQLite keeps it.
std::vector<std::pair<std::string, std::string>> views();
/// A query for v_summary over all families of a point together: `family` is ''; points in the order of their
/// definition.
std::string query_of_overall();
/// Drops the views that are there and makes them.
std::string views_sql();
/// Makes them in the connection alone, before those of the file: the views of a store that another build wrote may
/// count otherwise.
std::string temporary_views_sql();
/// Drops and makes the index that v_summary is read from.
std::string summary_index_sql();

/// "PREFIXmanip_mean, PREFIXclearance_min_m, ...": what point_trial has a second time, beside outcome and time to goal.
std::string summary_list(const std::string& prefix = {});

/// What the report page says of each metric: a JSON list of {key, of, name, unit, better, decimals or significant,
/// head (over its column of the table of trials), summary {column, name} (in v_summary), text}. `of`: "trial", "world"
/// (its difficulty) or "machine" (timings).
std::string json_of_metrics();

/// The words for how a trial ends, a JSON list.
std::string json_of_outcomes();

/// The words for the numbers in columns of samples, JSON: a list for each of status, fallback, plan_mode, plan_reason.
std::string json_of_samples();

}  // namespace moma::store
