#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

#include "controller/describe/enumeration.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "world/scenario/family.h"
#include "world/scenario/worlds.h"
#include "world/world_json.h"

namespace moma::cli {
namespace {

using store::Cell;

Cell number(double value) { return std::isnan(value) ? Cell{} : Cell{value}; }
Cell number(int value) { return std::int64_t{value}; }

std::string motion_text(const Motion& motion) {
  struct Visitor {
    std::string operator()(const StaticMotion&) const { return "at rest"; }
    std::string operator()(const LinearMotion& m) const {
      return fmt::format("linear, {} m/s", vector_text(m.V_W.tail<3>()));
    }
    std::string operator()(const PathMotion& m) const { return fmt::format("path of {} poses", m.times.size()); }
    std::string operator()(const CircleMotion& m) const { return fmt::format("circle, {:.4g} rad/s", m.rate); }
    std::string operator()(const SplineMotion& m) const { return fmt::format("spline of {} points", m.times.size()); }
  };
  return std::visit(Visitor{}, motion);
}

void print(const World& world) {
  std::cout << fmt::format("world {} of family {}, seed {}, robot {}\n", world.index, terminal_safe(world.family),
                           world.seed, terminal_safe(world.robot));
  std::cout << fmt::format("start    base {} q {}\n", vector_text(world.start.base), vector_text(world.start.q));
  for (std::size_t i = 0; i <= world.further.size(); ++i) {
    const WorldGoal& goal = goal_of(world, i);
    const Eigen::Quaterniond q(goal.X_WG.linear());
    std::cout << fmt::format("goal     position {} quaternion (w x y z) {}, {}{}\n",
                             vector_text(goal.X_WG.translation()),
                             vector_text(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())), motion_text(goal.motion),
                             goal.stop ? "" : ", passed through");
  }
  if (world.upright)
    std::cout << fmt::format("upright  axis {} of E within {:.4g} rad of the vertical\n",
                             vector_text(world.upright->axis), world.upright->angle);
  if (world.held) std::cout << fmt::format("held     {}\n", terminal_safe(world.held->object));
  std::cout << fmt::format("witness  base {} q {}\n\n", vector_text(world.witness.base), vector_text(world.witness.q));
  store::QueryResult difficulty{{}, {{}}};
  for_members<Difficulty>([&](std::string_view name, auto member, const Column&) {
    std::string& head = difficulty.columns.emplace_back(name);
    std::ranges::replace(head, '_', ' ');
    difficulty.rows.front().push_back(number(world.difficulty.*member));
  });
  write(std::cout, difficulty, Format::kTable);
  if (world.objects.empty()) return;
  store::QueryResult objects{{"object", "shape (m)", "position", "motion"}, {}};
  for (const WorldObject& object : world.objects) {
    objects.rows.push_back(
        {object.name, shape_text(object.shape), vector_text(object.X_WO.translation()), motion_text(object.motion)});
  }
  std::cout << '\n';
  write(std::cout, objects, Format::kTable);
}

struct WorldOptions {
  SuiteOptions suite;
  std::int64_t index = 0;
  bool json = false;
};

int show_world(const WorldOptions& options) {
  const Suite suite = options.suite.load();
  const SuitePoint& point = suite.points.front();
  if (point.worlds.size() >= 0 && options.index >= point.worlds.size()) {
    throw UsageError(
        fmt::format("world {}: the suite's frozen set has the worlds 0 to {}", options.index, point.worlds.size() - 1));
  }
  const World world = point.worlds.make(point.robot->model, static_cast<std::uint64_t>(options.index));
  if (options.json) {
    std::cout << to_json(world).dump() << '\n';
  } else {
    print(world);
  }
  return kOk;
}

}  // namespace

void add_world(Commands& commands) {
  auto [command, options] = commands.add<WorldOptions>("world", "Show one generated world of a suite", &show_world);
  options.suite.add_to(command);
  command.add_option("INDEX", options.index, "Number of the world, from 0")
      ->required()
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 62));
  command.add_flag("--json", options.json, "As JSON, the format of frozen worlds");
  command.footer("Families of worlds: " + joined(family_types(), &FamilyType::name) +
                 "\nExample: moma world configs/suites/demo.yaml 17 --json");
}

}  // namespace moma::cli
