#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "eval/cli/command.h"
#include "eval/cli/page_parts.h"
#include "eval/cli/suite_options.h"
#include "reports/render/report.h"

namespace moma::cli {

void add_open(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    reports::Stores stores;
    ReportOptions report;
    PageOptions page;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("open", "Write a store's report page beside it and open it in the browser");
  command->add_option("DB", options->stores, "Store; several are compared on one page")->required();
  options->page.add_to(*command);
  add_force(*command, options->report.replace);
  command->footer(
      "The page is the first store's name with .html. $BROWSER names the program that opens it; else it is xdg-open.\n"
      "Example: moma open results/demo.db");
  command->callback([&action, options] {
    action = [options] {
      const std::filesystem::path html = std::filesystem::path(options->stores.front()).replace_extension(".html");
      options->page.complete(options->report);
      write_report(options->stores, html, options->report);
      std::cerr << fmt::format("wrote {}\n", html.string());
      if (!reports::open_in_browser(html))
        std::cerr << "no browser could be started (BROWSER names one): open the file yourself\n";
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
