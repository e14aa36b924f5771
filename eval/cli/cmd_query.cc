#include <fmt/format.h>

#include <iostream>

#include "controller/config/node.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/summary_table.h"
#include "eval/cli/table.h"
#include "eval/run/named_point.h"
#include "eval/store/query.h"

namespace moma::cli {
namespace {

struct QueryOptions {
  std::string file;
  std::string sql;
  Format format = Format::kTable;
};

std::string sql_of(const QueryOptions& options) {
  const std::string name = options.sql.substr(1);
  std::vector<std::string> names{"@best"};
  for (const store::NamedQuery& query : store::named_queries()) {
    if (query.name == name) return std::string(query.sql);
    names.push_back(fmt::format("@{}", query.name));
  }
  throw UsageError(fmt::format("query: unknown query {}{}; there are {}", terminal_safe(options.sql),
                               config::suggestion(options.sql, names), fmt::join(names, ", ")));
}

/// "@best", "mine@best".
bool asks_for_best(const std::string& sql) { return sql.ends_with("@best") && sql.find(' ') == std::string::npos; }

store::QueryResult best_points(const QueryOptions& options) {
  store::QueryResult table{{"suite", "controller", "point", "by"}, {}};
  for (const run::NamedPoint& point : run::named_points(options.file, options.sql))
    table.rows.push_back({point.suite, point.controller, point.label, point.why});
  return table;
}

store::QueryResult answer(const QueryOptions& options) {
  if (options.sql == "@summary") return summary_table(options.file, "", for_person(options.format));
  if (asks_for_best(options.sql)) return best_points(options);
  if (options.sql.starts_with('@')) return store::query(options.file, sql_of(options));
  // A person's query may take any time; Ctrl-C ends it.
  return store::query(options.file, options.sql, std::chrono::minutes(0));
}

std::string footer() {
  std::string text = "Named queries:\n";
  text += fmt::format("  @{:<9} {}\n", "best",
                      "the best point of each suite, of one controller as NAME@best: the one with");
  text += fmt::format("  {:<10} {}\n", "", run::kBestCriterion);
  for (const store::NamedQuery& query : store::named_queries()) {
    text += fmt::format("  @{:<9} {}\n", query.name, query.description);
  }
  return text +
         "Views: v_trials (one flat row per trial), v_summary, v_pairs, v_metric_summary; docs/reference/store.md "
         "describes them.\n"
         "Examples: moma query results/demo.db @summary\n"
         "          moma query results/demo.db \"SELECT outcome, count(*) FROM v_trials GROUP BY 1\" --format csv";
}

int query(const QueryOptions& options) {
  write(std::cout, answer(options), options.format);
  return kOk;
}

}  // namespace

void add_query(Commands& commands) {
  auto [command, options] =
      commands.add<QueryOptions>("query", "Ask a store: read-only SQL, or a named query such as @summary", &query);
  add_store(command, options.file);
  command.add_option("SQL", options.sql, "One SQL statement, or @summary, @list, @failures, @pairs, @worst, @best")
      ->required();
  add_format(command, options.format);
  command.footer(footer());
}

}  // namespace moma::cli
