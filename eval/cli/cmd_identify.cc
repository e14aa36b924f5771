#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/identify/found_files.h"
#include "eval/identify/motion_log.h"
#include "files/output_file.h"

namespace moma::cli {
namespace {

struct IdentifyOptions {
  std::string log, disturbances, controller;
  files::Replace replace = files::Replace::kOwn;
};

int identify_robot(const IdentifyOptions& options) {
  const files::Kind kind{"file of what was identified", ""};
  const OutputFile disturbances(options.disturbances, kind, options.replace);
  const OutputFile controller(options.controller, kind, options.replace);
  const identify::Found found = identify::identify(identify::read_log(options.log));
  std::cout << identify::summary(found) << std::flush;
  const std::string source = fs::path(options.log).filename().string();
  if (disturbances.wanted()) disturbances.write(disturbances_file(found, source));
  if (controller.wanted()) controller.write(controller_file(found, source));
  return kOk;
}

}  // namespace

void add_identify(Commands& commands) {
  auto [command, options] = commands.add<IdentifyOptions>(
      "identify", "Latencies, ramps and noise of a robot, from a log of its commands and measured states",
      &identify_robot);
  command.add_option("LOG", options.log, "CSV with a head; its columns are in docs/how-to/identify.md")->required();
  command.add_option("--disturbances", options.disturbances, "Write a file for a suite's `disturbances`");
  command.add_option("--controller", options.controller, "Write a controller file with `prediction` and `uncertainty`");
  add_force(command, options.replace);
  command.footer(
      "Example: moma replay results/demo.db 3f9a12 --log drive.csv\n"
      "         moma identify drive.csv --disturbances my-robot.yaml --controller my-prediction.yaml");
}

}  // namespace moma::cli
