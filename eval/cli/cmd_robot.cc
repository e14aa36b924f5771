#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "controller/config/robot_file.h"
#include "controller/config/yaml_text.h"
#include "controller/draft/draft_robot.h"
#include "controller/fit/fit_robot.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/warnings.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;
using store::Cell;

/// `moma robot --fit-shapes`.
struct RobotFitOptions {
  std::filesystem::path robot;
  std::filesystem::path output;    ///< a robot file over `robot`; empty: the block goes to stdout
  std::vector<std::string> kinds;  ///< of sphere, capsule, box
  int max_shapes = 3;
  files::Replace replace = files::Replace::kOwn;  ///< of `output`
};

/// Shapes found for a robot file.
struct FittedShapes {
  std::string block;      ///< `collision` of a robot file, with how well it fits as a comment
  std::string report;     ///< that comment, for a terminal
  std::string collision;  ///< `collision` alone
  std::vector<std::string> warnings;
};

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

/// A robot file is edited by hand: none gives way by itself.
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

using nlohmann::ordered_json;
using store::Cell;
using store::QueryResult;

Cell limit(double value) {
  if (std::isinf(value)) return std::string(value > 0 ? "none" : "-none");
  return value;
}

ordered_json number_or_null(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

void print_base(const RobotModel& model) {
  const MobileBase& base = model.base;
  std::cout << fmt::format("{}: {} base, {} joints, {} links, {} collision shapes, {} self-collision pairs\n",
                           terminal_safe(model.name), to_string(base.type), model.num_joints(), model.links.size() - 1,
                           model.shapes.size(), model.self_pairs.size());
  if (model.mobile()) {
    std::cout << fmt::format("base: at most {:.4g} m/s, {:.4g} rad/s; {:.4g} m/s^2, {:.4g} rad/s^2", base.max_linear,
                             base.max_angular, base.max_acceleration.x(), base.max_acceleration.y());
    if (base.wheels) {
      std::cout << fmt::format("; wheels: radius {:.4g} m, separation {:.4g} m, at most {:.4g} rad/s",
                               base.wheels->radius, base.wheels->separation, base.wheels->max_speed);
    }
    std::cout << '\n';
  }
  std::cout << fmt::format("mount: {}; end effector: {} + {}\n\n", vector_text(base.X_BM.translation()),
                           terminal_safe(model.links[static_cast<std::size_t>(model.tip)].name),
                           vector_text(model.X_TE.translation()));
}

QueryResult joint_table(const RobotModel& model) {
  QueryResult table{{"joint", "type", "lower", "upper", "velocity", "effort", "ready", "moves"}, {}};
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(i)];
    table.rows.push_back({joint.name, std::string(to_string(joint.type)), limit(joint.lower), limit(joint.upper),
                          joint.velocity, joint.effort, model.ready[i],
                          model.links[static_cast<std::size_t>(joint.link)].name});
  }
  return table;
}

QueryResult link_table(const RobotModel& model) {
  QueryResult table{{"link", "parent", "joint", "type", "mass kg", "held at", "shapes"}, {}};
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    std::string shapes;
    for (const CollisionShape& shape : model.shapes) {
      if (shape.link != static_cast<int>(i)) continue;
      if (!shapes.empty()) shapes += "; ";
      shapes += shape_text(shape.shape);
    }
    const bool held = link.controlled < 0 && link.joint_type != JointType::kFixed;
    table.rows.push_back({link.name,
                          link.parent < 0 ? std::string() : model.links[static_cast<std::size_t>(link.parent)].name,
                          link.joint, link.parent < 0 ? std::string() : std::string(to_string(link.joint_type)),
                          link.inertial ? Cell{link.inertial->mass} : Cell{}, held ? Cell{link.held} : Cell{}, shapes});
  }
  return table;
}

QueryResult sensor_table(const RobotModel& model) {
  QueryResult table{{"sensor", "link", "position m", "looks along", "view rad", "rays", "range m", "frames/s"}, {}};
  for (const MountedSensor& mounted : model.sensors) {
    const Sensor& s = mounted.sensor;
    table.rows.push_back({s.name, model.links[static_cast<std::size_t>(mounted.link)].name, vector_text(s.position),
                          vector_text(mounted.X_LC.linear().col(0)),
                          fmt::format("{:.4g} x {:.4g}", s.field_of_view[0], s.field_of_view[1]),
                          fmt::format("{} x {}", s.columns, s.rows), s.range, s.rate});
  }
  return table;
}

double total_mass(const RobotModel& model) {
  double mass = model.base.mass;
  for (const Link& link : model.links) mass += link.inertial ? link.inertial->mass : 0.0;
  return mass;
}

/// What a robot file was read with, and what shows only when somebody looks.
std::vector<std::string> all_warnings(const std::string& file, const config::LoadedRobot& robot) {
  std::vector<std::string> all = robot.warnings;
  for (const auto& more : {run::holding_warnings(robot.model), run::wheel_warnings(*robot.model),
                           run::visual_warnings(file, *robot.model)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

ordered_json to_json(const config::LoadedRobot& robot, const std::vector<std::string>& warnings) {
  const RobotModel& model = *robot.model;
  ordered_json json = {{"name", model.name},
                       {"base", std::string(to_string(model.base.type))},
                       {"velocities", model.velocity_names()},
                       {"tip", model.links[static_cast<std::size_t>(model.tip)].name},
                       {"mass", total_mass(model)}};
  json["joints"] = ordered_json::array();
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(i)];
    json["joints"].push_back({{"name", joint.name},
                              {"type", std::string(to_string(joint.type))},
                              {"lower", number_or_null(joint.lower)},
                              {"upper", number_or_null(joint.upper)},
                              {"velocity", joint.velocity},
                              {"effort", joint.effort},
                              {"ready", model.ready[i]},
                              {"link", model.links[static_cast<std::size_t>(joint.link)].name}});
  }
  json["links"] = ordered_json::array();
  for (const Link& link : model.links) {
    json["links"].push_back(
        {{"name", link.name},
         {"parent",
          link.parent < 0 ? ordered_json() : ordered_json(model.links[static_cast<std::size_t>(link.parent)].name)},
         {"joint", link.joint},
         {"type", std::string(to_string(link.joint_type))},
         {"mass", link.inertial ? ordered_json(link.inertial->mass) : ordered_json()}});
  }
  json["shapes"] = ordered_json::array();
  for (const CollisionShape& shape : model.shapes) {
    json["shapes"].push_back({{"name", shape.name},
                              {"link", model.links[static_cast<std::size_t>(shape.link)].name},
                              {"shape", std::string(to_string(shape.shape.kind))},
                              {"size", {shape.shape.size.x(), shape.shape.size.y(), shape.shape.size.z()}}});
  }
  json["self_pairs"] = ordered_json::array();
  for (const SelfPair& pair : model.self_pairs) {
    json["self_pairs"].push_back({model.shapes[static_cast<std::size_t>(pair.first)].name,
                                  model.shapes[static_cast<std::size_t>(pair.second)].name});
  }
  json["warnings"] = warnings;
  json["notes"] = robot.notes;
  json["resolved"] = robot.resolved;
  return json;
}

/// Replaces any file: check_output() has refused those that are not to be replaced.
void write_text(const std::filesystem::path& file, const std::string& text) {
  files::write_file(file, robot_file_kind(), files::Replace::kAny, [&](std::ostream& out) { out << text; });
}

// The draft's last block gives way to the fitted shapes. They are larger than what they enclose, so that the posture is
// looked for again with them; which pairs count, it finds out itself.
draft::Draft add_shapes(const RobotFitOptions& options, const std::filesystem::path& folder, bool lenient,
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

/// `moma robot URDF`: a first robot file over the URDF that `options.robot` names, to `options.output` or stdout, with
/// fitted shapes on request (they need an output). Returns the exit code. Throws UsageError, config::ConfigError.
int draft_robot_file(const RobotFitOptions& options, bool fit, bool lenient) {
  if (fit && options.output.empty()) throw UsageError("--fit-shapes of a URDF needs -o FILE, the robot file to write");
  if (!options.output.empty()) check_output(options);
  const std::filesystem::path folder =
      options.output.empty() ? std::filesystem::path(".") : std::filesystem::absolute(options.output).parent_path();
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

}  // namespace

void add_robot(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    std::string file;
    bool json = false;
    bool fit = false;
    bool lenient = false;
    RobotFitOptions fit_options;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "robot", "Read a robot file, or draft one from a URDF: joints, limits, links, shapes, warnings");
  command->add_option("ROBOT", options->file, "Robot file (YAML), or a URDF: a first robot file is printed then")
      ->required();
  CLI::Option* json = command->add_flag("--json", options->json, "As JSON, with the resolved robot");
  CLI::Option* fit = command->add_flag("--fit-shapes", options->fit,
                                       "Enclose the URDF's collision meshes and cylinders in simple shapes: prints "
                                       "`collision` and how well it fits");
  fit->excludes(json);
  command->add_flag("--lenient", options->lenient,
                    "What is not understood in the URDF is left out with a warning; for other commands too, `lenient: "
                    "true` in the robot file does the same");
  RobotFitOptions& o = options->fit_options;
  command->add_option("--max-shapes", o.max_shapes, "Most shapes per link for its meshes and cylinders")
      ->check(CLI::Range(1, 12))
      ->capture_default_str()
      ->needs(fit);
  command->add_option("--shapes", o.kinds, "Kinds to choose from (sphere,capsule,box)")
      ->delimiter(',')
      ->check(CLI::IsMember({"sphere", "capsule", "box"}))
      ->needs(fit);
  command->add_option("-o,--output", o.output,
                      "Write a robot file: of a URDF the first one, else ROBOT with the shapes");
  add_force(*command, o.replace);
  command->footer(
      "Examples: moma robot configs/robots/frankie.yaml\n"
      "          moma robot my_robot.urdf -o my_robot.yaml\n"
      "          moma robot my_robot.yaml --fit-shapes -o my_robot_shapes.yaml");
  command->callback([&action, options] {
    action = [options] {
      options->fit_options.robot = options->file;
      if (draft::is_urdf(options->file)) {
        if (options->json) throw UsageError("--json is of a robot file; write one first with -o");
        return draft_robot_file(options->fit_options, options->fit, options->lenient);
      }
      if (options->fit) {
        if (options->lenient) throw UsageError("--fit-shapes takes `lenient: true` from the robot file");
        return fit_shapes(options->fit_options);
      }
      if (!options->fit_options.output.empty())
        throw UsageError(options->file + ": is a robot file already; -o writes one of a URDF, or with --fit-shapes");
      config::Node file = config::load_yaml(options->file);
      if (options->lenient) config::set_value(file, "lenient", "true");
      const config::LoadedRobot robot = config::read_robot(file, "");
      const std::vector<std::string> warnings = all_warnings(options->file, robot);
      if (options->json) {
        std::cout << to_json(robot, warnings).dump(2) << '\n';
        return static_cast<int>(kOk);
      }
      print_base(*robot.model);
      write(std::cout, joint_table(*robot.model), Format::kTable);
      std::cout << '\n';
      write(std::cout, link_table(*robot.model), Format::kTable);
      if (!robot.model->sensors.empty()) {
        std::cout << '\n';
        write(std::cout, sensor_table(*robot.model), Format::kTable);
      }
      std::cout << fmt::format("\ntotal mass {:.4g} kg\n", total_mass(*robot.model)) << std::flush;
      for (const std::string& note : robot.notes) std::cout << "note: " << note << '\n';
      print_warnings(warnings);
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
