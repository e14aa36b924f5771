#include "eval/cli/robot_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <sstream>

#include "controller/config/yaml_text.h"
#include "controller/fit/fit_robot.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;
using store::Cell;

// "capsule, 2 boxes".
std::string kinds_text(const std::vector<fit::Placed>& shapes) {
  std::map<ShapeKind, int> count;
  for (const fit::Placed& placed : shapes) ++count[placed.solid.shape.kind];
  std::string text;
  for (const auto& [kind, n] : count) {
    const std::string name(to_string(kind));
    text += text.empty() ? "" : ", ";
    text += n == 1 ? name : fmt::format("{} {}{}", n, name, kind == ShapeKind::kBox ? "es" : "s");
  }
  return text;
}

Cell millimetres(double metres) { return std::round(1e4 * metres) / 10.0; }

store::QueryResult error_table(const fit::RobotFit& fit) {
  store::QueryResult table{{"link", "URDF", "shapes", "volume / hull", "overshoot mean mm", "max mm", "uncovered mm"},
                           {}};
  for (const fit::LinkFit& link : fit.links) {
    if (link.fitted.empty()) {
      table.rows.push_back({link.link, link.had, std::string("kept"), {}, {}, {}, {}});
      continue;
    }
    std::string shapes = kinds_text(link.fitted);
    if (!link.kept.empty()) shapes += fmt::format(" ({} kept)", kinds_text(link.kept));
    table.rows.push_back({link.link, link.had, shapes,
                          link.error.volume_ratio ? Cell{std::round(100.0 * *link.error.volume_ratio) / 100.0} : Cell{},
                          millimetres(link.error.mean_overshoot), millimetres(link.error.most_overshoot),
                          millimetres(link.error.uncovered)});
  }
  for (const std::string& name : fit.own)
    table.rows.push_back({name, std::string("not used"), std::string("the file's own"), {}, {}, {}, {}});
  return table;
}

std::string touching_text(const std::vector<std::pair<std::string, std::string>>& links) {
  if (links.empty()) return "none";
  std::string text;
  for (const auto& [a, b] : links) text += fmt::format("{}{} - {}", text.empty() ? "" : ", ", a, b);
  return text;
}

std::string self_text(const fit::RobotFit& fit) {
  std::vector<std::pair<std::string, std::string>> added;
  for (const auto& pair : fit.after.touching)
    if (std::find(fit.before.touching.begin(), fit.before.touching.end(), pair) == fit.before.touching.end())
      added.push_back(pair);
  return fmt::format(
      "shapes {}, were {}; self-collision pairs {}, were {}; links in touch at `ready` {}, were {}; new among them: "
      "{}\n",
      fit.after.shapes, fit.before.shapes, fit.after.pairs, fit.before.pairs, fit.after.touching.size(),
      fit.before.touching.size(), touching_text(added));
}

std::string report(const fit::RobotFit& fit) {
  std::ostringstream text;
  write(text, error_table(fit), Format::kTable);
  text << "\nOvershoot: from the shapes' outer surface to the hull of what they enclose, on 2,000 points.\n"
       << self_text(fit);
  const auto same =
      std::count_if(fit.links.begin(), fit.links.end(), [](const fit::LinkFit& link) { return !link.like.empty(); });
  if (same > 0) text << fmt::format("links with the geometry of an earlier one, and its shapes: {}\n", same);
  return text.str();
}

std::string with_prefix(const std::string& text, const std::string& prefix) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::string whole = prefix + line;
    whole.erase(whole.find_last_not_of(' ') + 1);
    result += whole + "\n";
  }
  return result;
}

std::string collision(const fit::RobotFit& fit) { return "collision:\n" + with_prefix(fit.collision, "  "); }

std::string block(const fit::RobotFit& fit, const std::string& robot) {
  return with_prefix(fmt::format("Shapes around the URDF's {} geometry of {}, by moma robot --fit-shapes.\n\n{}",
                                 fit.of_visuals ? "visual" : "collision", terminal_safe(robot), report(fit)),
                     "# ") +
         collision(fit);
}

}  // namespace

const files::Kind& robot_file_kind() {
  static const files::Kind kind{"robot file", ""};
  return kind;
}

void check_output(const RobotFitOptions& options) {
  std::error_code error;
  if (fs::equivalent(options.output, options.robot, error))
    throw UsageError(fmt::format("{}: is the robot file itself; name another file", options.output.string()));
  files::check_replace(options.output, robot_file_kind(), options.replace);
}

FittedShapes fitted_shapes(const RobotFitOptions& options) {
  fit::FitOptions fit_options;
  fit_options.max_shapes = options.max_shapes;
  if (!options.kinds.empty()) {
    const auto named = [&](const char* kind) {
      return std::find(options.kinds.begin(), options.kinds.end(), kind) != options.kinds.end();
    };
    fit_options.kinds = {.sphere = named("sphere"), .capsule = named("capsule"), .box = named("box")};
  }
  StatusLine line(false);
  const fit::RobotFit fit =
      fit::fit_robot(options.robot, fit_options, [&](const std::string& link, std::size_t number, std::size_t links) {
        line.show(
            [&] { return fmt::format("fitting shapes to link {} of {}: {}", number, links, terminal_safe(link)); });
      });
  line.clear();
  return {block(fit, options.robot.filename().string()), report(fit), collision(fit), fit.warnings};
}

int fit_shapes(const RobotFitOptions& options) {
  if (!options.output.empty()) check_output(options);
  const FittedShapes fitted = fitted_shapes(options);
  if (options.output.empty()) {
    std::cout << fitted.block << std::flush;
  } else {
    std::error_code error;
    const fs::path folder = fs::absolute(options.output).parent_path();
    fs::path robot = fs::relative(options.robot, folder, error);
    if (error || robot.empty()) robot = fs::absolute(options.robot);
    files::write_file(options.output, robot_file_kind(), options.replace, [&](std::ostream& out) {
      out << "include: " << config::yaml_scalar(robot.generic_string()) << '\n' << fitted.block;
    });
    std::cout << fitted.report << std::flush;
    std::cerr << fmt::format("wrote {}, a robot file over {}\n", options.output.string(), options.robot.string());
  }
  print_warnings(fitted.warnings);
  return kOk;
}

}  // namespace moma::cli
