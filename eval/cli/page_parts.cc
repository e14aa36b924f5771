#include "eval/cli/page_parts.h"

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
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/time_known.h"
#include "eval/store/error.h"
#include "eval/store/samples.h"

namespace moma::cli {
namespace {

/// Where a robot's meshes are looked for.
struct Place {
  config::PackagePaths packages;
  std::filesystem::path folder;
};

Place place_of(const std::filesystem::path& robot_file, std::string& urdf) {
  const config::Node node = config::load_yaml(robot_file);
  config::MapReader robot(node, "");
  config::RobotBuild build;
  config::read_urdf_of(robot, build);
  urdf = build.resolved.at("urdf_text").get<std::string>();
  return {build.packages, build.urdf_directory};
}

reports::VisualPart part_of(const UrdfVisual& visual, const Place& place) {
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
  const config::Mesh mesh = config::read_mesh(place.packages.resolve(geometry.mesh, place.folder), geometry.scale);
  for (const Vector3& p : mesh.vertices) part.surface.vertices.push_back({p.x(), p.y(), p.z()});
  for (const Eigen::Vector3i& t : mesh.triangles) part.surface.triangles.push_back({t.x(), t.y(), t.z()});
  return part;
}

std::array<double, 3> point(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

reports::DistanceRows::Kind kind_of(const RowId& id) {
  using Kind = reports::DistanceRows::Kind;
  if (id.end > 0) return Kind::kEnd;
  if (id.kind == RowKind::kFloor) return Kind::kFloor;
  if (id.kind == RowKind::kSelf) return Kind::kSelf;
  return id.kind == RowKind::kPassing ? Kind::kPassing : Kind::kObject;
}

reports::DistanceRows rows_of(const TrialRows& of) {
  reports::DistanceRows out{of.names, {}};
  for (const TrialRows::Row& row : of.rows)
    out.rows.push_back({row.t, kind_of(row.id), row.first, row.second, row.active, row.id.d, point(row.id.p_first_W),
                        point(row.id.p_second_W)});
  return out;
}

/// What the URDF of a stored robot says that it looks like, with its meshes read from where package:// and file://
/// lead. `robots`: robot files; where one names the same URDF, its packages and its folder are looked in as well.
reports::Look robot_look(const std::vector<std::filesystem::path>& robots) {
  std::map<std::string, Place> places;
  for (const std::filesystem::path& robot : robots) {
    std::string urdf;
    Place place = place_of(robot, urdf);
    places[urdf] = std::move(place);
  }
  return [places](const nlohmann::ordered_json& robot) {
    std::vector<reports::VisualPart> parts;
    try {
      const std::string urdf = robot.at("urdf_text").get<std::string>();
      const auto named = places.find(urdf);
      for (const UrdfVisual& visual : read_urdf_visuals(urdf))
        parts.push_back(part_of(visual, named != places.end() ? named->second : Place{}));
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

/// Simulates a stored trial's motion and the rows of its QP again, from the store alone. `suites` has to outlive it.
reports::Simulate simulated_again(run::StoredSuites& suites) {
  return [&suites](const std::filesystem::path& db, const std::string& trial) -> std::optional<reports::OwnedSamples> {
    try {
      TrialRows rows;
      const run::Replay replay = run::replay(db, trial, suites, &rows);
      if (replay.output.trace.empty()) return {};
      store::EncodedSamples encoded = store::encode_samples(replay.output.trace);
      return reports::OwnedSamples{encoded.layout, encoded.n, store::column_names_of(encoded.columns),
                                   std::move(encoded.data), rows_of(rows)};
    } catch (const config::ConfigError& error) {
      throw reports::CannotSimulate(error.what());
    } catch (const store::StoreError& error) {
      if (error.kind() != store::StoreError::Kind::kNotFound) throw;
      throw reports::CannotSimulate(error.what());  // of another version of the simulation
    }
  };
}

std::string notes_of(const std::filesystem::path& file) {
  try {
    return config::read_text_file(file);
  } catch (const std::runtime_error& error) {
    throw UsageError(fmt::format("--notes {}: {}; wanted: a text file in Markdown", file.string(), error.what()));
  }
}

}  // namespace

void PageOptions::add_to(CLI::App& command) {
  command.add_option("--notes", notes_, "What you write about the results, Markdown, for the head of the page");
  CLI::Option* look = command.add_option(
      "--look", robots_, "Robot file by which the visual meshes of its URDF are found; may be given again");
  look->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--shapes", shapes_, "Show robots as their collision shapes, without visual meshes")->excludes(look);
  add_allow_plugins(command, plugins_);
}

void PageOptions::complete(ReportOptions& page) {
  if (!notes_.empty()) page.notes = notes_of(notes_);
  if (!shapes_) page.look = robot_look(robots_);
  suites_ = run::StoredSuites(plugins_);
  page.simulate = simulated_again(suites_);
  page.time_known = [](const reports::HitObject& hit) {
    return run::known_before_contact(
        {hit.world, hit.disturbances, hit.object, hit.control_period, hit.contact_time, hit.t, hit.base});
  };
}

}  // namespace moma::cli
