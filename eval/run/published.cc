#include "eval/run/published.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "controller/config/node.h"
#include "controller/config/reader.h"
#include "eval/run/listener.h"

namespace moma::run {
namespace {

using config::MapReader;
using config::Node;

constexpr const char* kFile = "published.yaml";

const Figure& read_figure(const Node& node, const std::string& key) {
  const std::string name = config::read_string(node, key);
  std::vector<std::string> names;
  for (const Figure& figure : figures()) {
    if (figure.name == name) return figure;
    names.emplace_back(figure.name);
  }
  config::fail(node.mark, key, fmt::format("found '{}', expected one of: {}", name, fmt::join(names, ", ")));
}

const std::vector<Node>& list_at(MapReader& in, const char* name, const char* what) {
  const Node& node = in.require(name, what);
  if (node.kind != Node::Kind::kSequence) config::fail(node.mark, in.key_of(name), fmt::format("expected {}", what));
  return node.items;
}

PublishedRow read_published_row(const Node& node, const std::string& key) {
  MapReader in(node, key);
  PublishedRow row;
  in.require("robot", "the robot's name");
  in.require("method", "the method's name");
  in.require("problems", "how many problems the figures are of");
  in.read("robot", row.robot);
  in.read("method", row.method);
  in.read("problems", row.problems, 1, 1000000000);
  for (const Figure& figure : figures()) {
    double value = 0.0;
    if (in.get(figure.name) == nullptr) continue;
    const bool rate = figure.kind == Figure::Kind::kRate;
    in.read(figure.name, value, rate ? config::Range{0.0, 100.0} : config::Range::non_negative());
    row.values[&figure] = value;
  }
  in.finish();
  return row;
}

Experiment read_entry(const std::string& name, const Node& node) {
  MapReader in(node, name);
  Experiment out;
  out.name = name;
  const Node& suite = in.require("suite", "the suite that repeats the experiment");
  out.suite = (config::directory_of(suite.mark) / config::read_string(suite, in.key_of("suite"))).lexically_normal();
  in.require("source", "where the figures were published");
  in.read("source", out.source);
  in.read_enum("averaging", out.averaging);
  for (const Node& item : list_at(in, "figures", "a list of figures"))
    out.figures.push_back(&read_figure(item, in.key_of("figures")));
  for (const Node& item : list_at(in, "pairs", "a list of [method, method]")) {
    if (item.kind != Node::Kind::kSequence || item.items.size() != 2)
      config::fail(item.mark, in.key_of("pairs"), "expected [method, method]");
    out.pairs.emplace_back(config::read_string(item.items[0], in.key_of("pairs")),
                           config::read_string(item.items[1], in.key_of("pairs")));
  }
  std::set<std::pair<std::string, std::string>> seen;
  for (const Node& item : list_at(in, "rows", "a list of published rows")) {
    out.rows.push_back(read_published_row(item, in.key_of("rows")));
    if (!seen.emplace(out.rows.back().robot, out.rows.back().method).second)
      config::fail(item.mark, in.key_of("rows"), "this robot has a row of this method already");
  }
  in.finish();
  return out;
}

}  // namespace

std::span<const Figure> figures() {
  using enum Figure::Kind;
  static const std::array kAll = {
      Figure{"success_rate", "success %", kRate, "t.outcome = 'success'", 100.0, 1},
      Figure{"failure_rate", "failures %", kRate, "t.outcome <> 'success'", 100.0, 1},
      Figure{"collision_rate", "collisions %", kRate, "t.outcome = 'collision'", 100.0, 1},
      Figure{"mean_manipulability", "mean manip.", kMean, "t.manip_all_mean", 1.0, 4},
      Figure{"final_manipulability", "final manip.", kMean, "t.manip_all_final", 1.0, 4},
      Figure{"mean_translational_manipulability", "mean transl. manip.", kMean, "t.manip_mean", 1.0, 4},
      Figure{"final_translational_manipulability", "final transl. manip.", kMean, "t.manip_final", 1.0, 4},
      Figure{"time_to_goal", "mean time to goal s", kMean, "t.time_to_goal_s", 1.0, 2},
      Figure{"path_of_base", "base's path m", kMean, "t.path_base_m", 1.0, 2},
      Figure{"average_time", "time ms", kClock, "e.t_step_median_us", 1e-3, 3},
  };
  return kAll;
}

const PublishedRow* Experiment::find(const std::string& robot, const std::string& method) const {
  const auto found =
      std::ranges::find_if(rows, [&](const auto& row) { return row.robot == robot && row.method == method; });
  return found != rows.end() ? &*found : nullptr;
}

Experiment read_experiment(const fs::path& file, const std::string& name) {
  const Node root = config::load_yaml(file);
  if (root.kind != Node::Kind::kMap || root.entries.empty())
    config::fail({file.string(), 0, 0}, "", "expected a map of experiments");
  std::vector<std::string> names;
  for (const auto& [entry, node] : root.entries) {
    if (entry == name) return read_entry(name, node);
    names.push_back(entry);
  }
  config::fail({file.string(), 0, 0}, "",
               fmt::format("there is no experiment '{}'{}; there are: {}", name, config::suggestion(name, names),
                           fmt::join(names, ", ")));
}

fs::path find_published() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& origin : {fs::current_path(error), program}) {
    for (fs::path at = origin; !at.empty(); at = at.parent_path()) {
      for (const fs::path& folder : {at / "configs", at / "share" / "moma" / "configs"})
        if (fs::is_regular_file(folder / kFile, error)) return folder / kFile;
      if (at == at.parent_path()) break;
    }
  }
  throw RunError(
      fmt::format("there is no configs/{} in the working folder, beside the program {}, or above either; "
                  "name it: --published FILE",
                  kFile, program.string()));
}

}  // namespace moma::run
