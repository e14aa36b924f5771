#include "eval/tune/tuning.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "eval/trial/trial.h"

namespace moma::tune {

namespace {

using config::ConfigError;
using config::Node;

// Raised by hand when the search takes another path for the same settings: stored searches of before are not resumed.
constexpr int kSearchVersion = 3;

// "controller.k" and "controllers.NAME.k" become "k"; anything else is not the controller's: "".
std::string inner_key(const std::string& key, const std::string& controller) {
  if (key.starts_with("controller.")) return key.substr(11);
  const std::string own = "controllers." + controller + ".";
  return key.starts_with(own) ? key.substr(own.size()) : "";
}

const Node* descend(const Node& root, const std::string& dotted) {
  const Node* node = &root;
  for (std::size_t from = 0; node != nullptr;) {
    const std::size_t dot = dotted.find('.', from);
    node = node->find(std::string_view(dotted).substr(from, dot == std::string::npos ? dot : dot - from));
    if (dot == std::string::npos) break;
    from = dot + 1;
  }
  return node;
}

// The value that a key has now, where it is one number (or a list of equal ones).
double present_value(const Node& resolved, const std::string& key, const config::Mark& mark,
                     const std::string& full_key) {
  const Node* node = descend(resolved, key);
  if (node != nullptr && node->kind == Node::Kind::kSequence && !node->items.empty()) {
    const bool equal =
        std::ranges::all_of(node->items, [&](const Node& item) { return item.scalar == node->items.front().scalar; });
    node = equal ? &node->items.front() : nullptr;
  }
  if (node != nullptr && node->kind == Node::Kind::kScalar) {
    try {
      const double value = config::read_number(*node, full_key, Range{-1e300, 1e300, false, false});
      if (std::isfinite(value)) return value;
    } catch (const ConfigError&) {  // a word such as inverse_error
    }
  }
  config::fail(mark, "tune.variables." + full_key,
               fmt::format("has no start: the controller's own value {}is not one finite number; give `start`",
                           node != nullptr ? fmt::format("({}) ", node->scalar) : ""));
}

Overrides without_sweep(const Overrides& overrides, const Overrides& part) {
  Overrides all = overrides;
  all.insert(all.end(), part.begin(), part.end());
  all.emplace_back("sweep", "null");
  return all;
}

/// The suite of each part of the mixture, without its sweep.
std::vector<Suite> load_parts(const fs::path& file, const Overrides& overrides, const std::vector<Overrides>& mixture) {
  std::vector<Suite> suites;
  for (const Overrides& part : mixture) suites.push_back(load_suite(file, without_sweep(overrides, part)));
  return suites;
}

void find_tuned_points(Tuning& tuning) {
  for (const Suite& suite : tuning.suites) {
    const auto found = std::ranges::find_if(
        suite.points, [&](const SuitePoint& p) { return p.controller == tuning.config.controller; });
    if (found == suite.points.end())
      config::fail(tuning.config.mark, "tune.mixture",
                   fmt::format("a part has no controller '{}', which is tuned", tuning.config.controller));
    tuning.tuned_point.push_back(static_cast<std::size_t>(found - suite.points.begin()));
  }
}

/// Variables without a start begin where the controller is.
void take_starts(Tuning& tuning) {
  TuneConfig& tune = tuning.config;
  const SuitePoint& first = tuning.suites.front().points[tuning.tuned_point.front()];
  const Node resolved = config::node_from_json(first.controller_resolved, tuning.file.string());
  for (std::size_t i = 0; i < tune.variables.size(); ++i) {
    Variable& v = tune.variables[i];
    const std::string inner = inner_key(v.key, tune.controller);
    if (v.key == "tune" || v.key.starts_with("tune.") || v.key == "trials" || v.key.starts_with("sweep")) {
      config::fail(tune.marks[i], "tune.variables." + v.key, "is one for the whole suite and cannot be searched");
    }
    if (inner.empty() && v.key.starts_with("controllers.")) {
      config::fail(tune.marks[i], "tune.variables." + v.key,
                   fmt::format("is not a key of the controller that is tuned, '{}'", tune.controller));
    }
    if (!std::isnan(v.start)) continue;
    if (inner.empty())
      config::fail(tune.marks[i], "tune.variables." + v.key, "give `start`: only a controller's own keys have one");
    v.start = present_value(resolved, inner, tune.marks[i], v.key);
    try {
      check(v);
    } catch (const std::invalid_argument& error) {
      config::fail(tune.marks[i], "tune.variables",
                   fmt::format("{} (the controller's own value); widen the range or give `start`", error.what()));
    }
  }
}

void check_worlds(const Tuning& tuning) {
  for (const Suite& suite : tuning.suites) {
    const long long size = suite.points.front().worlds.size();
    if (size < 0) continue;
    const TuneConfig& c = tuning.config;
    const std::uint64_t needed = std::max({c.worlds.end(), c.confirm.end(), c.held_out.end()});
    if (needed > static_cast<std::uint64_t>(size)) {
      config::fail(c.mark, "tune.held_out",
                   fmt::format("search, confirmation and held-out worlds reach to number {}, but the frozen set has {}",
                               needed - 1, size));
    }
  }
}

void check_ends(Tuning& tuning) {
  const Points points(tuning);
  const Candidate start = start_of(tuning.config.variables);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Variable& v = tuning.config.variables[i];
    for (const double end : {v.lower, v.upper}) {
      Candidate candidate = start;
      candidate[i] = end;
      try {
        points.make(candidate);
      } catch (const ConfigError& error) {
        tuning.warnings.push_back(
            fmt::format("tune.variables.{}: {} is refused while the others are at their start ({}); "
                        "such candidates count as worse than all",
                        v.key, end, error.what()));
      }
    }
  }
}

}  // namespace

Tuning load_tuning(const fs::path& file, const Overrides& overrides) {
  Tuning tuning;
  tuning.file = file;
  tuning.overrides = overrides;
  Node root = config::load_yaml(file);
  if (root.kind != Node::Kind::kMap) config::fail({file.string(), 0, 0}, "", "the suite is empty");
  for (const auto& [key, text] : overrides) {
    if (key.starts_with("tune.")) config::set_value(root, key, text);
  }
  const Node* section = root.find("tune");
  if (section == nullptr || section->kind != Node::Kind::kMap) {
    config::fail({file.string(), 0, 0}, "tune",
                 "missing; a suite to be tuned has tune: {variables: {...}, budget: {trials: 20000}, ...}");
  }
  const Node* controllers = root.find("controllers");
  std::vector<std::string> names;
  if (controllers != nullptr) {
    for (const auto& [name, node] : controllers->entries) names.push_back(name);
  }
  tuning.config = read_tune(*section, names);
  TuneConfig& tune = tuning.config;

  tuning.suites = load_parts(file, overrides, tune.mixture);
  find_tuned_points(tuning);
  for (const Suite& suite : tuning.suites) {
    for (const std::string& warning : suite.warnings) {
      if (std::ranges::find(tuning.warnings, warning) == tuning.warnings.end()) tuning.warnings.push_back(warning);
    }
    if (tune.held_out_seed && *tune.held_out_seed == suite.points.front().worlds.seed()) check_held_out(tune);
  }
  if (tune.held_out_seed) {
    Overrides seeded = overrides;
    seeded.emplace_back("worlds.seed", fmt::format("{}", *tune.held_out_seed));
    tuning.held_out_suites = load_parts(file, seeded, tune.mixture);
  }
  take_starts(tuning);
  // The start must be a good controller; this also finds unknown keys, one at a time so that the message names it.
  for (std::size_t i = 0; i <= tune.variables.size(); ++i) {
    const bool all = i == tune.variables.size();
    Tuning probe = tuning;
    if (!all) {
      probe.config.variables = {tune.variables[i]};
      probe.config.marks = {tune.marks[i]};
    }
    try {
      Points(probe).make(start_of(probe.config.variables));
    } catch (const ConfigError& error) {
      // One gain alone may contradict the preset's others; all together must not.
      if (!all && dynamic_cast<const config::KeyError*>(&error) == nullptr) continue;
      config::fail(all ? tune.mark : tune.marks[i], all ? "tune.variables" : "tune.variables." + tune.variables[i].key,
                   error.what());
    }
  }

  const Node& written = *controllers->find(tune.controller);
  tuning.controller_file = written.mark.file;
  tuning.controller = written;
  if (written.kind == Node::Kind::kScalar) {
    tuning.controller_file = config::directory_of(written.mark) / written.scalar;
    tuning.controller = config::load_yaml(tuning.controller_file);
  }
  for (const auto& [key, text] : overrides) {
    const std::string inner = inner_key(key, tune.controller);
    if (!inner.empty()) config::set_value(tuning.controller, inner, text);
  }
  // The result is written into another folder, from which a relative path would lead elsewhere.
  const SuitePoint& first = tuning.suites.front().points[tuning.tuned_point.front()];
  if (first.plugin != nullptr) anchor_paths(tuning.controller, *first.plugin, first.controller_resolved);

  check_worlds(tuning);
  check_ends(tuning);
  Json path = tune.written;
  for (const char* key : {"held_out", "output"}) path.erase(key);  // they decide what comes after the search
  tuning.identity = {{"search_version", kSearchVersion},
                     {"simulation_version", kSimulationVersion},
                     {"tune", std::move(path)},
                     {"controller", tune.controller},
                     {"suites", Json::array()}};
  for (const Suite& suite : tuning.suites) {
    Json part = suite.resolved;
    part.erase("robot");
    part.erase("trials");
    part.erase("samples");
    part["robot_digest"] = suite.points.front().robot_digest;
    tuning.identity["suites"].push_back(std::move(part));
  }
  return tuning;
}

Tuning stored_tuning(const Json& identity, const Json& held_out, const std::map<std::string, Json>& robots,
                     Plugins plugins) {
  if (identity.at("search_version") != kSearchVersion || identity.at("simulation_version") != kSimulationVersion)
    throw NotStored("another version of moma made it");
  const auto& parts = identity.at("suites");
  std::vector<std::string> names;
  for (const auto& [name, controller] : parts.at(0).at("controllers").items()) names.push_back(name);
  Json section = identity.at("tune");
  if (!held_out.is_null()) section["held_out"] = held_out;
  Tuning tuning;
  tuning.file = "stored search";
  tuning.identity = identity;
  tuning.config = read_tune(config::node_from_json(section, tuning.file.string()), names);
  for (const Variable& v : tuning.config.variables)
    if (inner_key(v.key, tuning.config.controller).empty())
      throw NotStored(fmt::format("it varies {}, which only the suite's file can be read with", v.key));
  for (Json part : parts) {
    const auto robot = robots.find(part.at("robot_digest").get<std::string>());
    if (robot == robots.end()) throw NotStored("a robot of it is not in the store");
    part.erase("robot_digest");
    part["robot"] = robot->second;
    part["trials"] = 1;
    part["samples"] = to_string(SamplesKept::kNone);
    tuning.suites.push_back(suite_from_resolved(part, plugins));
    if (!tuning.config.held_out_seed) continue;
    part["worlds"]["seed"] = *tuning.config.held_out_seed;
    tuning.held_out_suites.push_back(suite_from_resolved(part, plugins));
  }
  find_tuned_points(tuning);
  take_starts(tuning);
  return tuning;
}

SearchSettings search_settings(const Tuning& tuning) {
  const TuneConfig& c = tuning.config;
  SearchSettings s{c, {}, {}, {}};
  for (const MetricBound& bound : c.bounds) s.constraints.push_back(constraint_of(bound));
  const std::uint64_t parts = c.mixture.size();
  const auto numbers = [&](const WorldRange& range) {
    std::vector<std::uint64_t> list;
    for (std::uint64_t n = range.first * parts; n < range.end() * parts; ++n) list.push_back(n);
    return list;
  };
  s.worlds = numbers(c.worlds);
  s.confirm_worlds = numbers(c.confirm);
  s.confirmation.worlds *= parts;
  return s;
}

WorldOfPart world_of(const Tuning& tuning, std::uint64_t number) {
  const std::uint64_t parts = tuning.config.mixture.size();
  return {number / parts, static_cast<std::size_t>(number % parts)};
}

Points::Points(const Tuning& tuning) : tuning_(tuning) {
  for (const Variable& v : tuning.config.variables) {
    inner_keys_.push_back(inner_key(v.key, tuning.config.controller));
    only_controller_ = only_controller_ && !inner_keys_.back().empty();
  }
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    const SuitePoint& point = tuning.suites[part].points[tuning.tuned_point[part]];
    resolved_.push_back(config::node_from_json(stored_controller(point), "controller"));
  }
}

std::vector<SuitePoint> Points::make(const Candidate& candidate) const {
  return only_controller_ ? from_controller(candidate) : from_suite(candidate);
}

std::vector<SuitePoint> Points::from_controller(const Candidate& candidate) const {
  std::vector<SuitePoint> points;
  for (std::size_t part = 0; part < resolved_.size(); ++part) {
    SuitePoint point = tuning_.suites[part].points[tuning_.tuned_point[part]];
    Node node = resolved_[part];
    for (std::size_t i = 0; i < candidate.size(); ++i) config::set_value(node, inner_keys_[i], to_text(candidate[i]));
    std::vector<std::string> warnings;  // said of the start already
    set_controller(point, read_suite_controller(node, "controllers." + point.controller, point.robot,
                                                point.simulation.control_period, warnings));
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<SuitePoint> Points::from_suite(const Candidate& candidate) const {
  std::vector<SuitePoint> points;
  for (const Overrides& part : tuning_.config.mixture) {
    Overrides all = without_sweep(tuning_.overrides, part);
    for (std::size_t i = 0; i < candidate.size(); ++i) {
      const std::string key = inner_keys_[i].empty()
                                  ? tuning_.config.variables[i].key
                                  : "controllers." + tuning_.config.controller + "." + inner_keys_[i];
      all.emplace_back(key, to_text(candidate[i]));
    }
    Suite suite = load_suite(tuning_.file, all);
    const auto found = std::ranges::find_if(
        suite.points, [&](const SuitePoint& p) { return p.controller == tuning_.config.controller; });
    points.push_back(std::move(*found));
  }
  return points;
}

std::string objective_text(const Tuning& tuning) {
  std::string text =
      tuning.config.cost.standard()
          ? "default: T + 5/3 L x command change + 1/6 L x manipulability lost; L = time limit, T = time to "
            "goal, 2 L for a failure, 4 L for a collision"
          : tuning.config.written["objective"].dump();
  for (const MetricBound& bound : tuning.config.bounds) text += fmt::format("; {}", constraint_of(bound).name);
  return text;
}

}  // namespace moma::tune
