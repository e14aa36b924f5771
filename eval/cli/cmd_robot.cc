#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>

#include "controller/config/node.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/config/yaml_text.h"
#include "controller/describe/enumeration.h"
#include "controller/draft/draft_robot.h"
#include "controller/fit/fit_robot.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/warnings.h"

namespace moma::cli {
namespace {

using store::Cell;

struct RobotOptions {
  fs::path file;    ///< robot file, or a URDF
  fs::path output;  ///< robot file to write; empty: to stdout
  bool json = false;
  bool lenient = false;
  bool fit = false;                               ///< fits shapes
  std::vector<std::string> kinds;                 ///< of fitted shapes: of sphere, capsule, box
  int max_shapes = 3;                             ///< of a link
  files::Replace replace = files::Replace::kOwn;  ///< of `output`
};

// "capsule, 2 boxes".
std::string kinds_text(const std::vector<fit::Placed>& shapes) {
  std::map<ShapeKind, int> count;
  for (const fit::Placed& placed : shapes) ++count[placed.solid.shape.kind];
  return fit::kinds_text(count);
}

Cell millimetres(double metres) { return rounded(1e3 * metres, 0.1); }

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
                          link.error.volume_ratio ? Cell{rounded(*link.error.volume_ratio, 0.01)} : Cell{},
                          millimetres(link.error.mean_overshoot), millimetres(link.error.most_overshoot),
                          millimetres(link.error.uncovered)});
  }
  for (const std::string& name : fit.own)
    table.rows.push_back({name, std::string("not used"), std::string("the file's own"), {}, {}, {}, {}});
  return table;
}

std::string self_text(const fit::RobotFit& fit) {
  std::vector<std::string> added;
  for (const auto& pair : fit.after.touching)
    if (std::ranges::find(fit.before.touching, pair) == fit.before.touching.end())
      added.push_back(pair.first + " - " + pair.second);
  return fmt::format(
      "shapes {}, were {}; self-collision pairs {}, were {}; links in touch at `ready` {}, were {}; new among them: "
      "{}\n",
      fit.after.shapes, fit.before.shapes, fit.after.pairs, fit.before.pairs, fit.after.touching.size(),
      fit.before.touching.size(), added.empty() ? "none" : joined(added));
}

std::string report(const fit::RobotFit& fit) {
  std::ostringstream text;
  write(text, error_table(fit), Format::kTable);
  text << "\nOvershoot: from the shapes' outer surface to the hull of what they enclose, on 2,000 points.\n"
       << self_text(fit);
  const auto same = std::ranges::count_if(fit.links, [](const fit::LinkFit& link) { return !link.like.empty(); });
  if (same > 0) text << fmt::format("links with the geometry of an earlier one, and its shapes: {}\n", same);
  return text.str();
}

std::string collision(const fit::RobotFit& fit) {
  std::string section = "collision:\n";
  std::istringstream lines(fit.collision);
  for (std::string line; std::getline(lines, line);) section += "  " + line + "\n";
  return section;
}

std::string block(const fit::RobotFit& fit, const std::string& robot) {
  return config::yaml_comment(
             fmt::format("Shapes around the URDF's {} geometry of {}, by moma robot --fit-shapes.\n\n{}",
                         fit.of_visuals ? "visual" : "collision", terminal_safe(robot), report(fit))) +
         collision(fit);
}

/// People edit robot files: none is overwritten without --force.
const files::Kind& robot_file_kind() {
  static const files::Kind kind{"robot file", ""};
  return kind;
}

void check_output(const RobotOptions& options) {
  std::error_code error;
  if (options.output.empty()) return;
  if (fs::equivalent(options.output, options.file, error))
    throw UsageError(fmt::format("{}: is the robot file itself; name another file", options.output.string()));
  files::check_replace(options.output, robot_file_kind(), options.replace);
}

/// Fits shapes to the links of a robot file.
fit::RobotFit fitted_shapes(const RobotOptions& options, const fs::path& robot_file) {
  fit::FitOptions fit_options;
  fit_options.max_shapes = options.max_shapes;
  if (!options.kinds.empty()) {
    const auto named = [&](const char* kind) { return std::ranges::find(options.kinds, kind) != options.kinds.end(); };
    fit_options.kinds = {.sphere = named("sphere"), .capsule = named("capsule"), .box = named("box")};
  }
  StatusLine line(false);
  return fit::fit_robot(robot_file, fit_options, [&](const std::string& link, std::size_t number, std::size_t links) {
    line.show([&] { return fmt::format("fitting shapes to link {} of {}: {}", number, links, terminal_safe(link)); });
  });
}

/// `moma robot --fit-shapes` of a robot file.
int fit_shapes(const RobotOptions& options) {
  if (options.lenient) throw UsageError("--fit-shapes takes `lenient: true` from the robot file");
  check_output(options);
  const fit::RobotFit fit = fitted_shapes(options, options.file);
  const std::string fitted = block(fit, options.file.filename().string());
  if (options.output.empty()) {
    std::cout << fitted << std::flush;
  } else {
    std::error_code error;
    fs::path robot = fs::relative(options.file, fs::absolute(options.output).parent_path(), error);
    if (error || robot.empty()) robot = fs::absolute(options.file);
    files::write_file(options.output, robot_file_kind(), options.replace, [&](std::ostream& out) {
      out << "include: " << config::yaml_scalar(robot.generic_string()) << '\n' << fitted;
    });
    std::cout << report(fit) << std::flush;
    std::cerr << fmt::format("wrote {}, a robot file over {}\n", options.output.string(), options.file.string());
  }
  print_warnings(fit.warnings);
  return kOk;
}

using store::QueryResult;

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
                           terminal_safe(model.link(model.tip).name), vector_text(model.X_TE.translation()));
}

/// `for_person`: what has no limit says so in words; programs get nothing.
QueryResult joint_table(const RobotModel& model, bool for_person) {
  QueryResult table{{"joint", "type", "lower", "upper", "velocity", "effort", "ready", "moves"}, {}};
  if (!for_person) table.columns.front() = "name", table.columns.back() = "link";
  const auto limit = [&](double value) {
    if (std::isfinite(value)) return Cell{value};
    return for_person ? Cell{std::string(value > 0 ? "none" : "-none")} : Cell{};
  };
  for (const ControlledJoint& joint : model.joints)
    table.rows.push_back({joint.name, std::string(to_string(joint.type)), limit(joint.lower), limit(joint.upper),
                          joint.velocity, joint.effort, model.ready[static_cast<Eigen::Index>(table.rows.size())],
                          model.link(joint.link).name});
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
    table.rows.push_back({link.name, link.parent < 0 ? std::string() : model.link(link.parent).name, link.joint,
                          link.parent < 0 ? std::string() : std::string(to_string(link.joint_type)),
                          link.inertial ? Cell{link.inertial->mass} : Cell{}, held ? Cell{link.held} : Cell{}, shapes});
  }
  return table;
}

QueryResult sensor_table(const RobotModel& model) {
  QueryResult table{
      {"sensor", "link", "position m", "looks along", "view rad", "rays", "range m", "frames/s", "head rad"}, {}};
  for (const MountedSensor& mounted : model.sensors) {
    const Sensor& s = mounted.sensor;
    table.rows.push_back({s.name, model.link(mounted.link).name, vector_text(s.position),
                          vector_text(mounted.X_LC.linear().col(0)),
                          fmt::format("{:.4g} x {:.4g}", s.field_of_view[0], s.field_of_view[1]),
                          fmt::format("{} x {}", s.columns, s.rows), s.range, s.rate,
                          s.head.turns() ? fmt::format("pan {:.4g} to {:.4g}, tilt {:.4g} to {:.4g}", s.head.pan[0],
                                                       s.head.pan[1], s.head.tilt[0], s.head.tilt[1])
                                         : ""});
  }
  return table;
}

double total_mass(const RobotModel& model) {
  double mass = model.base.mass;
  for (const Link& link : model.links) mass += link.inertial ? link.inertial->mass : 0.0;
  return mass;
}

/// Returns the reader's warnings, and those of checks that this command alone makes.
std::vector<std::string> all_warnings(const fs::path& file, const config::LoadedRobot& robot) {
  std::vector<std::string> all = robot.warnings;
  for (const auto& more : {run::holding_warnings(robot.model), run::wheel_warnings(*robot.model),
                           run::visual_warnings(file, *robot.model)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

Json to_json(const config::LoadedRobot& robot, const std::vector<std::string>& warnings) {
  const RobotModel& model = *robot.model;
  Json json = {{"name", model.name},
               {"base", std::string(to_string(model.base.type))},
               {"velocities", model.velocity_names()},
               {"tip", model.link(model.tip).name},
               {"mass", total_mass(model)}};
  const auto name_of = [&](int link) { return link < 0 ? Cell{} : Cell{model.link(link).name}; };
  json["joints"] = rows_as_json(joint_table(model, false));
  QueryResult links{{"name", "parent", "joint", "type", "mass"}, {}};
  for (const Link& link : model.links)
    links.rows.push_back({link.name, name_of(link.parent), link.joint, std::string(to_string(link.joint_type)),
                          link.inertial ? Cell{link.inertial->mass} : Cell{}});
  json["links"] = rows_as_json(links);
  json["shapes"] = Json::array();
  for (const CollisionShape& shape : model.shapes) {
    json["shapes"].push_back({{"name", shape.name},
                              {"link", model.link(shape.link).name},
                              {"shape", std::string(to_string(shape.shape.kind))},
                              {"size", {shape.shape.size.x(), shape.shape.size.y(), shape.shape.size.z()}}});
  }
  json["self_pairs"] = Json::array();
  for (const SelfPair& pair : model.self_pairs) {
    json["self_pairs"].push_back({model.shape(pair.first).name, model.shape(pair.second).name});
  }
  json["warnings"] = warnings;
  json["notes"] = robot.notes;
  json["resolved"] = robot.resolved;
  return json;
}

/// Replaces any file: check_output() has refused those that are not to be replaced.
void write_text(const fs::path& file, const std::string& text) {
  files::write_file(file, robot_file_kind(), files::Replace::kAny, [&](std::ostream& out) { out << text; });
}

// The draft's last block gives way to the fitted shapes. They are larger than what they enclose, so that the posture is
// looked for again with them; which pairs count, it finds out itself.
draft::Draft add_shapes(const RobotOptions& options, const fs::path& folder, const draft::Draft& with_urdfs) {
  fit::RobotFit fit = fitted_shapes(options, options.output);
  std::string shapes = collision(fit);
  constexpr std::string_view kAuto = "self: auto", kNone = "self: []";
  if (const std::size_t at = shapes.rfind(kAuto); at != std::string::npos) shapes.replace(at, kAuto.size(), kNone);
  draft::Draft draft = draft::draft_robot({options.file, folder, options.lenient, shapes, with_urdfs.meshes});
  if (draft.text != with_urdfs.text) {
    write_text(options.output, draft.text);
    fit = fitted_shapes(options, options.output);  // the shapes are the same, what they say of `ready` is not
  }
  write_text(options.output,
             draft.text.substr(0, draft.text.rfind("collision:")) + block(fit, options.output.filename().string()));
  std::cout << report(fit) << std::flush;
  return draft;
}

void print_notes(const std::vector<std::string>& notes, std::ostream& out) {
  for (const std::string& note : notes) out << "note: " << note << '\n';
}

/// `moma robot URDF`: a first robot file over the URDF, to `output` or stdout, with fitted shapes on request (they need
/// an output).
int draft_robot_file(const RobotOptions& options) {
  if (options.json) throw UsageError("--json is of a robot file; write one first with -o");
  if (options.fit && options.output.empty())
    throw UsageError("--fit-shapes of a URDF needs -o FILE, the robot file to write");
  check_output(options);
  const fs::path folder = options.output.empty() ? fs::path(".") : fs::absolute(options.output).parent_path();
  draft::Draft draft = draft::draft_robot({options.file, folder, options.lenient, ""});
  if (options.output.empty()) {
    std::cout << draft.text << std::flush;
    print_notes(draft.notes, std::cerr);
    print_warnings(draft.warnings);
    return kOk;
  }
  write_text(options.output, draft.text);
  if (options.fit) draft = add_shapes(options, folder, draft);
  const config::LoadedRobot robot = config::read_robot(config::load_yaml(options.output), "", draft.meshes);
  print_notes(robot.notes, std::cerr);
  print_warnings(robot.warnings);
  print_warnings(run::holding_warnings(robot.model));
  std::cerr << fmt::format("wrote {}; {} to check, see its comments\n", options.output.string(),
                           draft.checks == 1 ? "one line" : fmt::format("{} lines", draft.checks));
  return kOk;
}

int show_robot(const RobotOptions& options) {
  if (draft::is_urdf(options.file)) return draft_robot_file(options);
  if (options.fit) return fit_shapes(options);
  if (!options.output.empty())
    throw UsageError(options.file.string() +
                     ": is a robot file already; -o writes one of a URDF, or with --fit-shapes");
  config::Node file = config::load_yaml(options.file);
  if (options.lenient) config::set_value(file, "lenient", "true");
  const config::LoadedRobot robot = config::read_robot(file, "");
  const std::vector<std::string> warnings = all_warnings(options.file, robot);
  if (options.json) {
    std::cout << to_json(robot, warnings).dump(2) << '\n';
    return kOk;
  }
  print_base(*robot.model);
  write(std::cout, joint_table(*robot.model, true), Format::kTable);
  std::cout << '\n';
  write(std::cout, link_table(*robot.model), Format::kTable);
  if (!robot.model->sensors.empty()) {
    std::cout << '\n';
    write(std::cout, sensor_table(*robot.model), Format::kTable);
  }
  std::cout << fmt::format("\ntotal mass {:.4g} kg\n", total_mass(*robot.model)) << std::flush;
  print_notes(robot.notes, std::cout);
  print_warnings(warnings);
  return kOk;
}

}  // namespace

void add_robot(Commands& commands) {
  auto [command, options] = commands.add<RobotOptions>(
      "robot", "Read a robot file, or draft one from a URDF: joints, limits, links, shapes, warnings", &show_robot);
  command.add_option("ROBOT", options.file, "Robot file (YAML), or a URDF: a first robot file is printed then")
      ->required();
  CLI::Option* json = command.add_flag("--json", options.json, "As JSON, with the resolved robot");
  CLI::Option* fit = command.add_flag("--fit-shapes", options.fit,
                                      "Enclose the URDF's collision meshes and cylinders in simple shapes: prints "
                                      "`collision` and how well it fits");
  fit->excludes(json);
  command.add_flag(
      "--lenient", options.lenient,
      "Parts of the URDF that moma does not understand are left out with a warning; for other commands too, `lenient: "
      "true` in the robot file does the same");
  command
      .add_option("--max-shapes", options.max_shapes, "Largest number of shapes per link for its meshes and cylinders")
      ->check(CLI::Range(1, 12))
      ->capture_default_str()
      ->needs(fit);
  command.add_option("--shapes", options.kinds, "Kinds to choose from (sphere,capsule,box)")
      ->delimiter(',')
      ->check(CLI::IsMember({"sphere", "capsule", "box"}))
      ->needs(fit);
  command.add_option("-o,--output", options.output,
                     "Write a robot file: of a URDF the first one, else ROBOT with the shapes");
  add_force(command, options.replace);
  command.footer(
      "Examples: moma robot configs/robots/frankie.yaml\n"
      "          moma robot my_robot.urdf -o my_robot.yaml\n"
      "          moma robot my_robot.yaml --fit-shapes -o my_robot_shapes.yaml");
}

}  // namespace moma::cli
