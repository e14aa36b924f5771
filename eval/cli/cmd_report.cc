#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/store/database.h"
#include "reports/render/report.h"

namespace moma::cli {

void add_report(CLI::App& app, Action& action) {
  struct Options {
    std::filesystem::path file;
    std::filesystem::path html;
    ReportOptions report;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "Write a store's results as one self-contained HTML page");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("-o,--output", options->html, "HTML file to write (the store's name with .html)");
  command->add_option("--replays", options->report.replays, "At most so many trials with their motion")
      ->check(CLI::Range(0, 100000));
  command->footer("Example: moma report results/demo.db -o reports/demo.html");
  command->callback([&action, options] {
    action = [options] {
      std::filesystem::path html = options->html;
      if (html.empty()) html = std::filesystem::path(options->file).replace_extension(".html");
      write_report(options->file, html, options->report);
      store::remove_empty_wal(options->file);
      std::cerr << fmt::format("wrote {}\n", html.string());
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
