#include <fmt/format.h>

#include <array>
#include <iostream>
#include <map>
#include <string>
#include <utility>

#include "controller/config/mesh_hull.h"
#include "controller/config/package_path.h"
#include "controller/config/robot_build.h"
#include "controller/config/text_file.h"
#include "controller/model/urdf.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/replay.h"
#include "eval/store/error.h"
#include "eval/store/migrations.h"
#include "eval/store/samples.h"
#include "reports/render/report.h"
#include "reports/render/store.h"
#include "reports/render/view.h"

namespace moma::cli {
namespace {

reports::VisualPart part_of(const UrdfVisual& visual, const config::PackagePaths& packages) {
  const UrdfGeometry& geometry = visual.geometry;
  reports::VisualPart part;
  part.link = visual.link;
  for (int row = 0; row < 3; ++row) {
    part.position[static_cast<std::size_t>(row)] = geometry.X_LS.translation()[row];
    for (int column = 0; column < 3; ++column)
      part.rotation[static_cast<std::size_t>(3 * row + column)] = geometry.X_LS.linear()(row, column);
  }
  if (visual.colour) part.colour = {visual.colour->x(), visual.colour->y(), visual.colour->z()};
  if (geometry.mesh.empty()) {
    const Vector3& size = geometry.shape.size;
    part.shape = {{"shape", to_string(geometry.shape.kind)}, {"size", {size.x(), size.y(), size.z()}}};
    return part;
  }
  const config::Mesh mesh = config::read_mesh(packages.resolve(geometry.mesh), geometry.scale);
  for (const Vector3& p : mesh.vertices) part.surface.vertices.push_back({p.x(), p.y(), p.z()});
  for (const Eigen::Vector3i& t : mesh.triangles) part.surface.triangles.push_back({t.x(), t.y(), t.z()});
  return part;
}

std::array<double, 3> point(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

reports::DistanceRows::Kind kind_of(const RowId& id) {
  using Kind = reports::DistanceRows::Kind;
  if (id.kind == RowKind::kFloor) return Kind::kFloor;
  if (id.kind == RowKind::kSelf) return Kind::kSelf;
  return Kind::kObject;
}

reports::DistanceRows rows_of(const TrialDetail& of) {
  reports::DistanceRows out{of.names, {}};
  for (const TrialDetail::Row& row : of.rows)
    out.rows.push_back({row.t, kind_of(row.id), row.first, row.second, row.active, row.id.d, point(row.id.p_first_W),
                        point(row.id.p_second_W)});
  return out;
}

reports::MapMotion map_of(const TrialDetail& of) {
  reports::MapMotion out{of.cell, TrialDetail::kMapRate, {}, {}};
  const auto numbers = [](const Eigen::Vector3i& cells) { return std::array{cells.x(), cells.y(), cells.z()}; };
  for (const TrialDetail::Box& box : of.boxes)
    out.boxes.push_back({box.from, box.to, box.seen, numbers(box.cells.low), numbers(box.cells.high)});
  for (const TrialDetail::Look& look : of.looks)
    out.looks.push_back({look.sensor, look.t, look.gaze.pan, look.gaze.tilt});
  return out;
}

/// Returns the looks of stored robots: the visual elements of their URDFs, with meshes from where package:// and
/// file:// lead. `robots`: robot files; where one names the same URDF, its packages and its folder are looked in as
/// well.
reports::Look robot_look(const std::vector<fs::path>& robots) {
  std::map<std::string, config::PackagePaths> places;  // by the URDF's text
  for (const fs::path& file : robots) {
    const config::Node node = config::load_yaml(file);
    config::MapReader robot(node, "");
    config::RobotBuild build;
    config::read_urdf_of(robot, build);
    places[build.resolved.at("urdf_text").get<std::string>()] = build.packages;
  }
  return [places](const Json& robot) {
    std::vector<reports::VisualPart> parts;
    try {
      const std::string urdf = robot.at("urdf_text").get<std::string>();
      const auto named = places.find(urdf);
      for (const UrdfVisual& visual : read_urdf_visuals(urdf))
        parts.push_back(part_of(visual, named != places.end() ? named->second : config::PackagePaths{}));
    } catch (const std::exception& error) {
      std::cerr << terminal_safe(fmt::format("robot {} is shown as its collision shapes: {}; where its robot file says "
                                             "more: --look ROBOT.yaml",
                                             robot.value("name", ""), error.what()))
                << '\n';
      parts.clear();
    }
    return parts;
  };
}

/// Simulates a stored trial's motion again, with the rows of its QP and its map, from the store alone.
/// `suites` has to outlive it.
reports::Simulate simulated_again(run::StoredSuites& suites) {
  return [&suites](const fs::path& db, const std::string& trial) -> std::optional<reports::OwnedSamples> {
    try {
      TrialDetail detail;
      const run::Replay replay = run::replay(db, trial, suites, &detail);
      if (replay.output.trace.empty()) return {};
      store::EncodedSamples encoded = store::encode_samples(replay.output.trace);
      return reports::OwnedSamples{encoded.layout,          encoded.n,       store::column_names_of(encoded.columns),
                                   std::move(encoded.data), rows_of(detail), map_of(detail)};
    } catch (const config::ConfigError& error) {
      throw reports::CannotSimulate(error.what());
    } catch (const store::StoreError& error) {
      if (error.kind() != store::StoreError::Kind::kNotFound) throw;
      throw reports::CannotSimulate(error.what());  // of another version of the simulation
    }
  };
}

std::string notes_of(const fs::path& file) {
  try {
    return config::read_text_file(file);
  } catch (const std::runtime_error& error) {
    throw UsageError(fmt::format("--notes {}: {}; wanted: a text file in Markdown", file.string(), error.what()));
  }
}

/// Options of every command with a report page. They outlive the page.
struct Page {
  reports::Stores stores;
  reports::ViewOptions report;
  fs::path notes;
  std::vector<fs::path> robots;
  bool shapes = false;
  Plugins plugins = Plugins::kRefused;
  run::StoredSuites suites;

  /// Adds DB, --notes, --look, --shapes and --allow-plugins.
  void add_to(CLI::App& command);
  /// The first store's name with .html.
  fs::path usual_file() const { return fs::path(stores.front()).replace_extension(".html"); }
  /// Gives `report` the notes, the robots' looks, and the simulation of stored trials. A robot with a mesh that cannot
  /// be found or read has no look, and a line on standard error says why. Throws UsageError (--notes) and
  /// config::ConfigError (--look).
  void complete();
  void write_to(const fs::path& html);
};

void tell_written(const fs::path& file) { std::cerr << fmt::format("wrote {}\n", file.string()); }

void Page::add_to(CLI::App& command) {
  add_store(command, stores, "Store; several are compared on one page");
  command.add_option("--notes", notes, "What you write about the results, Markdown, for the head of the page");
  CLI::Option* look = command.add_option(
      "--look", robots, "Robot file by which the visual meshes of its URDF are found; may be given again");
  look->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--shapes", shapes, "Show robots as their collision shapes, without visual meshes")->excludes(look);
  add_allow_plugins(command, plugins);
}

void Page::complete() {
  if (!notes.empty()) report.notes = notes_of(notes);
  if (!shapes) report.look = robot_look(robots);
  suites = run::StoredSuites(plugins);
  report.simulate = simulated_again(suites);
  report.time_known = [](const reports::HitObject& hit) {
    return run::known_before_contact(
        {hit.world, hit.disturbances, hit.object, hit.control_period, hit.contact_time, hit.t, hit.base});
  };
}

void Page::write_to(const fs::path& html) {
  complete();
  reports::write_report(stores, html, report);
  tell_written(html);
}

}  // namespace

static_assert(store::kSchemaVersion <= reports::kNewestSchema,
              "look whether reports/sql still fits the store, then raise reports/render/store.h");

namespace {

struct ReportFiles : Page {
  fs::path html;
};

int write_files(ReportFiles& options) {
  fs::path html = options.html;
  if (html.empty()) html = options.usual_file();
  options.write_to(html);
  return kOk;
}

int open_page(Page& options) {
  const fs::path html = options.usual_file();
  options.write_to(html);
  if (!reports::open_in_browser(html))
    std::cerr << "no browser could be started (BROWSER names one): open the file yourself\n";
  return kOk;
}

int serve_page(Page& options) {
  options.complete();
  const InterruptGuard guard;
  reports::serve(options.stores, options.report, InterruptGuard::flag(), [](const std::string& address) {
    std::cout << address << std::endl;
    std::cerr << "serving the report at the address above; Ctrl-C ends\n";
  });
  return kOk;
}

}  // namespace

void add_report(Commands& commands) {
  auto [command, options] =
      commands.add<ReportFiles>("report", "Write a store's results as one self-contained HTML page", &write_files);
  options.add_to(command);
  command.add_option("-o,--output", options.html, "HTML file to write (the first store's name with .html)");
  command.add_option("--trials", options.report.trials, "At most so many trials one by one; rates are of all")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000}))
      ->capture_default_str();
  command.add_option("--replays", options.report.replays, "At most so many trials with their motion")
      ->check(CLI::Range(0, 100000));
  command
      .add_option("--twins", options.report.twins,
                  "Of so many failures a success in the same world too, to play beside them")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  add_force(command, options.report.replace);
  command.footer(
      "Examples: moma report results/demo.db -o reports/demo.html\n"
      "          moma report before.db after.db");
}

void add_open(Commands& commands) {
  auto [command, options] =
      commands.add<Page>("open", "Write a store's report page beside it and open it in the browser", &open_page);
  options.add_to(command);
  add_force(command, options.report.replace);
  command.footer(
      "The page is the first store's name with .html. $BROWSER names the program that opens it; else it is xdg-open.\n"
      "Example: moma open results/demo.db");
}

void add_view(Commands& commands) {
  auto [command, options] =
      commands.add<Page>("view", "Serve a store's report page on this machine, also while a run goes on", &serve_page);
  options.add_to(command);
  command.add_option("--port", options.report.port, "Port of 127.0.0.1 (8080); 0: any free one")
      ->check(CLI::Range(0, 65535));
  command.footer("Example: moma view results/demo.db --port 0");
}

}  // namespace moma::cli
