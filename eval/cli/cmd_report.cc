#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/page_parts.h"
#include "eval/cli/suite_options.h"
#include "eval/store/migrations.h"
#include "reports/render/report.h"
#include "reports/render/store.h"

namespace moma::cli {
static_assert(store::kSchemaVersion <= reports::kNewestSchema,
              "look whether reports/sql still fits the store, then raise reports/render/store.h");

void add_report(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    reports::Stores stores;
    std::filesystem::path html;
    std::filesystem::path figures;
    std::filesystem::path table;
    ReportOptions report;
    PageOptions page;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "Write a store's results as one self-contained HTML page");
  command->add_option("DB", options->stores, "Store; several are compared on one page")->required();
  command->add_option("-o,--output", options->html, "HTML file to write (the first store's name with .html)");
  command->add_option("--trials", options->report.trials, "At most so many trials one by one; rates are of all")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000}))
      ->capture_default_str();
  command->add_option("--replays", options->report.replays, "At most so many trials with their motion")
      ->check(CLI::Range(0, 100000));
  command
      ->add_option("--twins", options->report.twins,
                   "Of so many failures a success in the same world too, to play beside them")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  options->page.add_to(*command);
  command->add_option("--figures", options->figures, "Write every figure as SVG and PDF into this folder (needs node)");
  command->add_option("--table", options->table, "Write the table of results for LaTeX (.tex)");
  add_force(*command, options->report.replace);
  command->footer(
      "With --figures or --table the page is written only where -o asks for it.\n"
      "Examples: moma report results/demo.db -o reports/demo.html\n"
      "          moma report before.db after.db --figures paper/figures --table paper/results.tex");
  command->callback([&action, options] {
    action = [options] {
      const reports::Stores& stores = options->stores;
      const files::Replace replace = options->report.replace;
      std::filesystem::path html = options->html;
      if (html.empty() && options->table.empty() && options->figures.empty())
        html = std::filesystem::path(stores.front()).replace_extension(".html");
      if (!html.empty()) files::check_replace(html, reports::page_kind(), replace);  // before a table is written
      std::vector<std::filesystem::path> written;
      if (!options->table.empty()) {
        write_table(stores, options->table, replace);
        written.push_back(options->table);
      }
      if (!options->figures.empty()) {
        for (auto& file : write_figures(stores, options->figures, replace)) written.push_back(std::move(file));
      }
      if (!html.empty()) {
        options->page.complete(options->report);
        write_report(stores, html, options->report);
        written.push_back(html);
      }
      for (const std::filesystem::path& file : written) std::cerr << fmt::format("wrote {}\n", file.string());
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
