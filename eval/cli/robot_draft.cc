#include "eval/cli/robot_draft.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <string>

#include "controller/config/robot_file.h"
#include "controller/draft/draft_robot.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/whole_file.h"
#include "eval/run/holding.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
  write_whole(file, [&](std::ostream& out) { out << text; });
}

// The draft's last block gives way to the fitted shapes.
void add_shapes(const RobotFitOptions& options, const std::string& draft) {
  RobotFitOptions over = options;
  over.robot = options.output;
  const FittedShapes fitted = fitted_shapes(over);
  write_text(options.output, draft.substr(0, draft.rfind("collision:")) + fitted.block);
  std::cout << fitted.report << std::flush;
}

}  // namespace

int draft_robot_file(const RobotFitOptions& options, bool fit, bool lenient) {
  if (fit && options.output.empty()) throw UsageError("--fit-shapes of a URDF needs -o FILE, the robot file to write");
  if (!options.output.empty()) check_output(options);
  const fs::path folder = options.output.empty() ? fs::path(".") : fs::absolute(options.output).parent_path();
  const draft::Draft draft = draft::draft_robot({options.robot, folder, lenient});
  if (options.output.empty()) {
    std::cout << draft.text << std::flush;
    for (const std::string& note : draft.notes) std::cerr << "note: " << note << '\n';
    print_warnings(draft.warnings);
    return kOk;
  }
  write_text(options.output, draft.text);
  if (fit) add_shapes(options, draft.text);
  const config::LoadedRobot robot = config::load_robot(options.output);
  for (const std::string& note : robot.notes) std::cerr << "note: " << note << '\n';
  print_warnings(robot.warnings);
  print_warnings(run::holding_warnings(robot.model));
  std::cerr << fmt::format("wrote {}; {} to check, see its comments\n", options.output.string(),
                           draft.checks == 1 ? "one line" : fmt::format("{} lines", draft.checks));
  return kOk;
}

}  // namespace moma::cli
