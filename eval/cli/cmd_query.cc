#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>

#include "controller/config/node.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/store/query.h"

namespace moma::cli {
namespace {

struct QueryOptions {
  std::string file;
  std::string sql;
  Format format = Format::kTable;
};

std::string sql_of(const QueryOptions& options) {
  if (options.sql.empty() || options.sql[0] != '@') return options.sql;
  const std::string name = options.sql.substr(1);
  std::vector<std::string> names;
  for (const store::NamedQuery& query : store::named_queries()) {
    const bool for_person = options.format == Format::kTable || options.format == Format::kMarkdown;
    if (query.name == name) return std::string(for_person && !query.display.empty() ? query.display : query.sql);
    names.push_back(fmt::format("@{}", query.name));
  }
  const std::string near = config::nearest(options.sql, names);
  throw UsageError(fmt::format("query: unknown query {}{}; there are {}", terminal_safe(options.sql),
                               near.empty() ? "" : fmt::format(" (did you mean {}?)", near), fmt::join(names, ", ")));
}

std::string footer() {
  std::string text = "Named queries:\n";
  for (const store::NamedQuery& query : store::named_queries()) {
    text += fmt::format("  @{:<9} {}\n", query.name, query.description);
  }
  return text +
         "Views: v_trials (one flat row per trial), v_summary, v_pairs; docs/reference/store.md describes them.\n"
         "Examples: moma query results/demo.db @summary\n"
         "          moma query results/demo.db \"SELECT outcome, count(*) FROM v_trials GROUP BY 1\" --format csv";
}

}  // namespace

void add_query(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  auto options = std::make_shared<QueryOptions>();
  CLI::App* command = app.add_subcommand("query", "Ask a store: read-only SQL, or a named query such as @summary");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("SQL", options->sql, "One SQL statement, or @summary, @list, @failures, @pairs, @worst")
      ->required();
  add_format(*command, options->format);
  command->footer(footer());
  command->callback([&action, options] {
    action = [options] {
      // What a person writes may take as long as it takes; Ctrl-C ends it.
      const bool own = !options->sql.starts_with('@');
      const auto patience = own ? std::chrono::minutes(0) : std::chrono::minutes(10);
      write(std::cout, store::query(options->file, sql_of(*options), patience), options->format);
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
