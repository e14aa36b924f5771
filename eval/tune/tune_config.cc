#include "eval/tune/tune_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/config/json_node.h"
#include "controller/config/read_described.h"

namespace moma::tune {
namespace {

using config::ConfigError;
using config::MapReader;
using config::Node;

constexpr long long kMost = 100'000'000;
constexpr long long kMostBudget = 1'000'000'000;

// Adds the place to an error of a part that knows no files.
template <typename Work>
auto at(const Node& node, const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    config::fail(node.mark, key, error.what());
  }
}

bool is_word(const Node* node, std::string_view word) {
  return node != nullptr && node->kind == Node::Kind::kScalar && node->scalar == word;
}

void read_variables(const Node& node, TuneConfig& tune) {
  const std::string key = "tune.variables";
  if (node.kind != Node::Kind::kMap || node.entries.empty()) {
    config::fail(node.mark, key,
                 "expected a map {KEY: {range: [low, high], scale: log, start: x}, ...} with at least one key");
  }
  for (const auto& [name, entry] : node.entries) {
    const std::string where = key + "." + name;
    MapReader in(entry, where);
    Variable v;
    v.key = name;
    const std::vector<double> range = config::read_numbers(in.require("range", "[low, high]"), where + ".range", 2);
    v.lower = range[0];
    v.upper = range[1];
    in.read_enum("scale", v.scale);
    v.start = std::numeric_limits<double>::quiet_NaN();
    in.read("start", v.start);
    in.finish();
    Variable checked = v;
    if (std::isnan(v.start)) checked.start = v.lower;
    at(entry, key, [&] {
      check(checked);
      return 0;
    });
    tune.variables.push_back(std::move(v));
    tune.marks.push_back(entry.mark);
  }
}

CostTerm read_term(const std::string& metric, const Node& node, const std::string& key, double sign,
                   const Node* weight_node) {
  CostTerm term{at(node, key, [&] { return Metric::find(metric); }), sign, std::nullopt};
  const Node* null_node = nullptr;
  if (weight_node != nullptr && weight_node->kind == Node::Kind::kMap) {
    MapReader in(*weight_node, key);
    double weight = 1.0;
    in.read("weight", weight);
    null_node = in.get("when_null");
    double when_null = 0.0;
    in.read("when_null", when_null);
    in.finish();
    term.weight = sign * weight;
    if (null_node != nullptr) term.when_null = when_null;
  } else if (weight_node != nullptr) {
    term.weight = sign * config::read_number(*weight_node, key);
  }
  const std::string_view when = term.metric.null_when();
  if (!when.empty() && !term.when_null) {
    config::fail(
        node.mark, key,
        fmt::format("{0} is NULL {1}; give a replacement: {{{0}: {{weight: 1, when_null: 60}}}}", metric, when));
  }
  return term;
}

TrialCost read_objective(const Node& node) {
  const std::string key = "tune.objective";
  if (is_word(&node, "default")) return {};
  if (node.kind != Node::Kind::kMap) {
    config::fail(node.mark, key,
                 fmt::format("found '{}', expected default, {{minimize: METRIC}}, {{maximize: METRIC}} or a weighted "
                             "sum {{minimize: {{METRIC: weight, ...}}}}",
                             node.scalar));
  }
  MapReader in(node, key);
  const Node* minimize = in.get("minimize");
  const Node* maximize = in.get("maximize");
  in.finish();
  if ((minimize == nullptr) == (maximize == nullptr)) in.fail("expected one of the keys minimize and maximize");
  const Node& what = minimize != nullptr ? *minimize : *maximize;
  const double sign = minimize != nullptr ? 1.0 : -1.0;
  const std::string where = key + (minimize != nullptr ? ".minimize" : ".maximize");
  std::vector<CostTerm> terms;
  if (what.kind == Node::Kind::kScalar) {
    terms.push_back(read_term(what.scalar, what, where, sign, nullptr));
  } else if (what.kind == Node::Kind::kMap && !what.entries.empty()) {
    for (const auto& [metric, weight] : what.entries)
      terms.push_back(read_term(metric, weight, where + "." + metric, sign, &weight));
  } else {
    config::fail(what.mark, where, "expected a metric's name or a map {METRIC: weight, ...}");
  }
  return TrialCost(std::move(terms));
}

std::vector<MetricBound> read_bounds(const Node* node) {
  std::vector<MetricBound> bounds;
  if (node == nullptr) return bounds;
  const std::string key = "tune.constraints";
  if (node->kind != Node::Kind::kMap)
    config::fail(node->mark, key, "expected a map such as {collision: {at_most: 0.01}}");
  for (const auto& [metric, entry] : node->entries) {
    const std::string where = key + "." + metric;
    MetricBound bound{at(entry, where, [&, name = metric] { return Metric::find(name); }), false, {}, {}};
    MapReader in(entry, where);
    const Node* at_most = in.get("at_most");
    const Node* at_least = in.get("at_least");
    if ((at_most == nullptr) == (at_least == nullptr)) in.fail("expected one of the keys at_most and at_least");
    bound.at_least = at_least != nullptr;
    const Node& given = bound.at_least ? *at_least : *at_most;
    if (!is_word(&given, "start")) bound.bound = config::read_number(given, where);
    if (const Node* null_node = in.get("when_null"))
      bound.when_null = config::read_number(*null_node, where + ".when_null");
    in.finish();
    const std::string_view when = bound.metric.null_when();
    if (!when.empty() && !bound.when_null) {
      config::fail(entry.mark, where, fmt::format("{} is NULL {}; give a replacement as when_null", metric, when));
    }
    bounds.push_back(std::move(bound));
  }
  return bounds;
}

// The default objective weighs success against other costs; this constraint prevents it from giving up success.
void keep_success(TuneConfig& tune) {
  const Metric success = Metric::find(to_string(Outcome::kSuccess));
  const bool told =
      std::ranges::any_of(tune.bounds, [&](const MetricBound& bound) { return bound.metric.name() == success.name(); });
  if (tune.cost.standard() && !told) tune.bounds.push_back({success, true, {}, {}});
}

std::vector<const AlgorithmInfo*> read_plan(const Node* node) {
  std::vector<const AlgorithmInfo*> plan;
  if (node == nullptr || is_word(node, "default")) return plan;
  const std::string key = "tune.algorithm";
  const std::vector<Node> single{*node};
  const std::vector<Node>& items = node->kind == Node::Kind::kSequence ? node->items : single;
  if (items.empty()) config::fail(node->mark, key, "expected at least one algorithm, or leave the key out");
  for (const Node& item : items)
    plan.push_back(at(item, key, [&] { return &find_algorithm(config::read_string(item, key)); }));
  return plan;
}

WorldRange read_worlds(const Node* node, const std::string& key, std::uint64_t first, std::uint64_t count,
                       std::optional<std::uint64_t>* seed = nullptr) {
  WorldRange range{first, count};
  if (node == nullptr) return range;
  if (node->kind != Node::Kind::kMap) {
    range.count = static_cast<std::uint64_t>(config::read_integer(*node, key, 1, kMost));
    return range;
  }
  MapReader in(*node, key);
  if (const Node* from = in.get("first"))
    range.first = static_cast<std::uint64_t>(config::read_integer(*from, key + ".first", 0, kMost));
  range.count = static_cast<std::uint64_t>(
      config::read_integer(in.require("count", "the number of worlds"), key + ".count", 1, kMost));
  if (seed != nullptr && in.get("seed") != nullptr) {
    unsigned long long value = 0;
    in.read("seed", value);
    *seed = value;
    if (in.get("first") == nullptr) range.first = 0;
  }
  in.finish();
  return range;
}

std::vector<Overrides> read_mixture(const Node* node) {
  std::vector<Overrides> mixture;
  if (node == nullptr) return {{}};
  const std::string key = "tune.mixture";
  if (node->kind != Node::Kind::kSequence || node->items.empty()) {
    config::fail(node->mark, key,
                 "expected a list of parts, each a map of suite keys: [{robot: A.yaml}, {robot: B.yaml}]");
  }
  for (const Node& item : node->items) {
    if (item.kind != Node::Kind::kMap || item.entries.empty())
      config::fail(item.mark, key, "expected a map of suite keys");
    Overrides part;
    for (const auto& [name, value] : item.entries) {
      if (name == "tune" || name == "sweep" || name == "name" || name == "trials") {
        config::fail(value.mark, key, fmt::format("'{}' is one for the whole suite", name));
      }
      std::string text = config::node_to_json(value).dump();
      // A file is relative to the suite that names it.
      const bool file = value.kind == Node::Kind::kScalar &&
                        (name == "robot" || name == "worlds.frozen" || value.scalar.ends_with(".yaml"));
      if (file) text = nlohmann::json(fs::absolute(config::directory_of(value.mark) / value.scalar).string()).dump();
      part.emplace_back(name, text);
    }
    mixture.push_back(std::move(part));
  }
  return mixture;
}

// The input and output of a key with its own reader.
struct Reading {
  const Node& section;
  const Node* node;  // null if the file has none
  const std::vector<std::string>& controllers;
  TuneConfig& tune;
};

void read_budget(const Reading& r) {
  MapReader budget(*r.node, "tune.budget");
  const Node& trials = budget.require("trials", "the number of trials that the search may use");
  r.tune.budget = static_cast<std::uint64_t>(config::read_integer(trials, "tune.budget.trials", 1, kMostBudget));
  budget.finish();
}

void read_controller_name(const Reading& r) {
  r.tune.controller = r.controllers.empty() ? "" : r.controllers.front();
  if (r.node != nullptr) r.tune.controller = config::read_string(*r.node, "tune.controller");
  if (std::ranges::find(r.controllers, r.tune.controller) == r.controllers.end()) {
    config::fail(
        r.node != nullptr ? r.node->mark : r.section.mark, "tune.controller",
        fmt::format("the suite has no controller '{}'; it has {}", r.tune.controller, fmt::join(r.controllers, ", ")));
  }
}

void read_output(const Reading& r) {
  const std::string file = r.node != nullptr ? config::read_string(*r.node, "tune.output") : "";
  if (!file.empty()) r.tune.output = config::directory_of(r.node->mark) / file;
}

// A key of the section with a reader of its own.
struct OwnKey {
  const char* name;
  const char* part;    // key within its map, as in the reference; "" for the whole value
  const char* wanted;  // name of the missing value if the key is required
  std::string accepted;
  const char* otherwise;
  const char* text;
  void (*read)(const Reading&);
  bool after = false;  // read after the others and TuneConfig's description, which has the remaining keys
};

std::string scales() {
  std::string text = list_of_words<Scale>();
  return text.replace(text.rfind(", "), 2, " or ");
}

// Keys in the order of the reference.
const std::vector<OwnKey>& own_keys() {
  static const std::vector<OwnKey> kKeys{
      {"variables", "", "a map {KEY: {range: [low, high], scale: log, start: x}, ...}",
       "a map {KEY: {range: [low, high], scale: " + scales() + ", start: x}}", "", "gains to search",
       [](const Reading& r) { read_variables(*r.node, r.tune); }},
      {"controller", "", "", "text", "the first", "controller of the suite to tune", read_controller_name},
      {"objective", "", "", "default, {minimize: METRIC} or {maximize: METRIC}, or weighted sums", "default",
       "objective to minimise or maximise",
       [](const Reading& r) {
         if (r.node != nullptr) r.tune.cost = read_objective(*r.node);
       }},
      {"constraints", "", "", "a map {METRIC: {at_most or at_least: x}}, where x is a number or start",
       "success as often as at the start", "conditions of the result",
       [](const Reading& r) { r.tune.bounds = read_bounds(r.node); }},
      {"algorithm", "", "", "default, a name, or a list of names or maps {name, share, population}", "default",
       "algorithms of NLopt", [](const Reading& r) { r.tune.plan = read_plan(r.node); }},
      {"budget", "trials", "{trials: 20000}", accepted_whole_number(1, kMostBudget), "",
       "largest number of trials of the search", read_budget},
      {"worlds", "", "", "a number, or {first, count}", "100", "worlds of the search",
       [](const Reading& r) { r.tune.worlds = read_worlds(r.node, "tune.worlds", 0, 100); }},
      {"held_out", "", "", "a number, or {first, count, seed}", "500", "worlds of the verdict, apart from the others",
       [](const Reading& r) {
         r.tune.held_out = read_worlds(r.node, "tune.held_out", r.tune.confirm.end(), 500, &r.tune.held_out_seed);
         r.tune.held_out_mark = (r.node != nullptr ? *r.node : r.section).mark;
       },
       true},
      {"mixture", "", "", "a list of maps {KEY: VALUE}", "", "parts of the suite with equal weights",
       [](const Reading& r) { r.tune.mixture = read_mixture(r.node); }},
      {"output", "", "", "a file", "", "file of the tuned controller", read_output},
  };
  return kKeys;
}

}  // namespace

TuneConfig read_tune(const Node& node, const std::vector<std::string>& controllers) {
  TuneConfig tune;
  tune.mark = node.mark;
  tune.written = config::node_to_json(node);
  MapReader in(node, "tune");
  const auto read = [&](bool after) {
    for (const OwnKey& key : own_keys()) {
      if (key.after != after) continue;
      const bool required = key.wanted[0] != '\0';
      key.read({node, required ? &in.require(key.name, key.wanted) : in.get(key.name), controllers, tune});
    }
  };
  read(false);
  keep_success(tune);
  tune.confirmation.worlds = tune.worlds.count;
  config::read_members(in, tune);
  in.check(tune.sensitivity.near < tune.sensitivity.far, "sensitivity", "far must be larger than near");
  tune.confirm = {tune.worlds.end(), tune.confirmation.candidates > 0 ? tune.confirmation.worlds : 0};
  read(true);
  in.finish();
  if (!tune.held_out_seed) check_held_out(tune);
  const std::uint64_t least = 2 * tune.worlds.count * tune.mixture.size();
  if (tune.budget < least) {
    config::fail(node.find("budget")->mark, "tune.budget.trials",
                 fmt::format("{} does not reach for two candidates ({} trials each); give at least {}, better {}",
                             tune.budget, least / 2, least, 10 * least));
  }
  return tune;
}

std::vector<Key> tune_keys(const std::string& prefix) {
  std::vector<Key> keys;
  for (const OwnKey& own : own_keys()) {
    const std::string part = own.part[0] != '\0' ? std::string(".") + own.part : "";
    keys.push_back({prefix + "." + own.name + part, "", own.accepted, own.otherwise, own.text});
  }
  for (Key& more : keys_of(TuneConfig{}, prefix)) keys.push_back(std::move(more));
  return keys;
}

void check_held_out(const TuneConfig& tune) {
  const auto overlap = [](const WorldRange& a, const WorldRange& b) {
    return a.count > 0 && b.count > 0 && a.first < b.end() && b.first < a.end();
  };
  for (const auto& [name, range] : {std::pair{"search", tune.worlds}, {"confirmation", tune.confirm}}) {
    if (!overlap(tune.held_out, range)) continue;
    config::fail(tune.held_out_mark, "tune.held_out",
                 fmt::format("worlds {} to {} overlap those of the {}, {} to {}: gains would be judged on worlds that "
                             "chose them; begin at {} or later, or give held_out a seed of its own",
                             tune.held_out.first, tune.held_out.end() - 1, name, range.first, range.end() - 1,
                             std::max(tune.worlds.end(), tune.confirm.end())));
  }
}

}  // namespace moma::tune
