#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/named_point.h"
#include "reports/render/changes.h"

namespace moma::cli {
namespace {

struct DiffOptions {
  std::string file;
  std::string a;
  std::string b;
  std::string other;
  std::string suite;
  Format format = Format::kTable;
};

store::Cell cell_of(const std::optional<std::string>& text) { return text ? store::Cell{*text} : store::Cell{}; }

int diff(const DiffOptions& options) {
  if (options.b.empty() && options.other.empty())
    throw UsageError("diff: name a second controller, or a second store by --with");
  const std::string& other = options.other.empty() ? options.file : options.other;
  const run::NamedPoint a = run::named_point(options.file, options.a, options.suite);
  const run::NamedPoint b = run::named_point(other, options.b.empty() ? options.a : options.b, options.suite);
  const auto changes = reports::setting_changes(reports::PointName{options.file, a.suite, a.controller, a.label},
                                                reports::PointName{other, b.suite, b.controller, b.label});
  store::QueryResult table{{"setting", "A", "B"}, {}};
  for (const reports::SettingChange& change : changes)
    table.rows.push_back({change.key, cell_of(change.from), cell_of(change.to)});
  if (options.format == Format::kTable || options.format == Format::kMarkdown) {
    const auto shown = [](const run::NamedPoint& point, const std::string& file) {
      return fmt::format("{} of {} ({}){}", point.name(), point.suite, file,
                         point.why.empty() ? "" : ", best by " + point.why);
    };
    std::cout << terminal_safe(fmt::format("A = {}", shown(a, options.file))) << '\n'
              << terminal_safe(fmt::format("B = {}", shown(b, other))) << "\n\n";
    if (changes.empty()) {
      std::cout << "they have the same settings\n";
      return kOk;
    }
  }
  write(std::cout, table, options.format);
  return kOk;
}

}  // namespace

void add_diff(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  auto options = std::make_shared<DiffOptions>();
  CLI::App* command =
      app.add_subcommand("diff", "Setting by setting, how two controllers of a store, or of two stores, differ");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("A", options->a, "Controller, CONTROLLER:POINT of a sweep, @best or CONTROLLER@best")->required();
  command->add_option("B", options->b, "The other one; A again where --with names another store");
  command->add_option("--with", options->other, "Store that B is of");
  command->add_option("--suite", options->suite, "Which suite, where several have one of them");
  add_format(*command, options->format);
  command->footer(
      "Compares gains, disturbances, worlds, simulation, tolerances and robot; what is not set on one side is blank.\n"
      "Examples: moma diff results/gains.db published mine@2\n"
      "          moma diff before.db mine --with after.db");
  command->callback([&action, options] { action = [options] { return diff(*options); }; });
}

}  // namespace moma::cli
