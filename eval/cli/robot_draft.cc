#include "eval/cli/robot_draft.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>

#include "controller/config/robot_file.h"
#include "controller/draft/draft_robot.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/run/holding.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

/// What it replaces was asked for, or is what it wrote itself: check_output() has looked.
void write_text(const fs::path& file, const std::string& text) {
  files::write_file(file, robot_file_kind(), files::Replace::kAny, [&](std::ostream& out) { out << text; });
}

// The draft's last block gives way to the fitted shapes. They are larger than what they enclose, so that the posture is
// looked for again with them; which pairs count, it finds out itself.
draft::Draft add_shapes(const RobotFitOptions& options, const fs::path& folder, bool lenient,
                        const draft::Draft& with_urdfs) {
  RobotFitOptions over = options;
  over.robot = options.output;
  FittedShapes fitted = fitted_shapes(over);
  constexpr std::string_view kAuto = "self: auto", kNone = "self: []";
  if (const std::size_t at = fitted.collision.rfind(kAuto); at != std::string::npos)
    fitted.collision.replace(at, kAuto.size(), kNone);
  draft::Draft draft = draft::draft_robot({options.robot, folder, lenient, fitted.collision});
  if (draft.text != with_urdfs.text) {
    write_text(options.output, draft.text);
    fitted = fitted_shapes(over);  // the shapes are the same, what they say of `ready` is not
  }
  write_text(options.output, draft.text.substr(0, draft.text.rfind("collision:")) + fitted.block);
  std::cout << fitted.report << std::flush;
  return draft;
}

}  // namespace

int draft_robot_file(const RobotFitOptions& options, bool fit, bool lenient) {
  if (fit && options.output.empty()) throw UsageError("--fit-shapes of a URDF needs -o FILE, the robot file to write");
  if (!options.output.empty()) check_output(options);
  const fs::path folder = options.output.empty() ? fs::path(".") : fs::absolute(options.output).parent_path();
  draft::Draft draft = draft::draft_robot({options.robot, folder, lenient, ""});
  if (options.output.empty()) {
    std::cout << draft.text << std::flush;
    for (const std::string& note : draft.notes) std::cerr << "note: " << note << '\n';
    print_warnings(draft.warnings);
    return kOk;
  }
  write_text(options.output, draft.text);
  if (fit) draft = add_shapes(options, folder, lenient, draft);
  const config::LoadedRobot robot = config::load_robot(options.output);
  for (const std::string& note : robot.notes) std::cerr << "note: " << note << '\n';
  print_warnings(robot.warnings);
  print_warnings(run::holding_warnings(robot.model));
  std::cerr << fmt::format("wrote {}; {} to check, see its comments\n", options.output.string(),
                           draft.checks == 1 ? "one line" : fmt::format("{} lines", draft.checks));
  return kOk;
}

}  // namespace moma::cli
