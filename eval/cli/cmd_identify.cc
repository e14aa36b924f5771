#include <filesystem>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/identify/found_files.h"
#include "eval/identify/motion_log.h"
#include "files/output_file.h"

namespace moma::cli {

void add_identify(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    std::string log, disturbances, controller;
    files::Replace replace = files::Replace::kOwn;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "identify", "Latencies, ramps and noise of a robot, from a log of its commands and measured states");
  command->add_option("LOG", options->log, "CSV with a head; its columns are in docs/how-to/identify.md")->required();
  command->add_option("--disturbances", options->disturbances, "Write a file for a suite's `disturbances`");
  command->add_option("--controller", options->controller,
                      "Write a controller file with `prediction` and `uncertainty`");
  add_force(*command, options->replace);
  command->footer(
      "Example: moma replay results/demo.db 3f9a12 --log drive.csv\n"
      "         moma identify drive.csv --disturbances my-robot.yaml --controller my-prediction.yaml");
  command->callback([&action, options] {
    action = [options] {
      const files::Kind kind{"file of what was identified", ""};  // people edit it
      for (const std::string& file : {options->disturbances, options->controller})
        if (!file.empty()) files::check_replace(file, kind, options->replace);
      const identify::Found found = identify::identify(identify::read_log(options->log));
      std::cout << identify::summary(found) << std::flush;
      const std::string source = std::filesystem::path(options->log).filename().string();
      if (!options->disturbances.empty())
        files::write_file(options->disturbances, kind, options->replace,
                          [&](std::ostream& out) { out << disturbances_file(found, source); });
      if (!options->controller.empty())
        files::write_file(options->controller, kind, options->replace,
                          [&](std::ostream& out) { out << controller_file(found, source); });
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
