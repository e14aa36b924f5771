#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/describe/describe.h"
#include "controller/describe/keys.h"
#include "eval/search/search.h"
#include "eval/suite/suite.h"
#include "eval/tune/trial_cost.h"

namespace moma::tune {

/// World indices first .. first + count - 1.
struct WorldRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
  std::uint64_t end() const { return first + count; }
};

/// The `tune` section of a suite, read and checked by itself. Variables of which the file has no start have NaN: the
/// controller's own value.
struct TuneConfig : SearchChoices {
  std::string controller;           ///< name of the tuned controller
  std::vector<config::Mark> marks;  ///< place of each variable
  TrialCost cost;
  std::vector<MetricBound> bounds;
  std::vector<Overrides> mixture;              ///< one assignment of suite keys per part; one empty one by default
  WorldRange worlds;                           ///< worlds of the search
  WorldRange confirm;                          ///< worlds for the best few
  WorldRange held_out;                         ///< worlds for the verdict
  std::optional<std::uint64_t> held_out_seed;  ///< their own worlds.seed
  fs::path output;                             ///< empty: chosen by the command
  config::Mark mark;
  config::Mark held_out_mark;
  Json written;  ///< the section as written in the file
};

/// Numbers, words and maps of them; the other keys have readers of their own.
constexpr void describe(auto& v, Of<TuneConfig>) {
  using T = TuneConfig;
  v.member("seed", &T::seed, {.text = "seed of the search's random draws"});
  v.member("starts", &T::starts, in_range({1, 1000}, "", "independent searches that share the budget"));
  v.member("racing", &T::racing, {.text = "none, or when a candidate is cut"});
  v.member("sensitivity", &T::sensitivity, {.text = "none, or the steps by which the found gains move one by one"});
  v.member("confirm", &T::confirmation, {.text = "none, or the further measurements of the best few"});
}

std::vector<Key> tune_keys(const std::string& prefix = "tune");

/// Reads `tune`:
///   variables: {KEY: {range: [low, high], scale: linear | log | integer, start: x}, ...}
///   objective: default | {minimize: METRIC | {METRIC: weight | {weight: w, when_null: v}, ...}} | {maximize: ...}
///   constraints: {METRIC: {at_most: x | at_least: x, when_null: v}, ...}, x a number or `start`. With the default
///     objective and no bound on success, {success: {at_least: start}} is added.
///   algorithm: NAME | [NAME, ...]
///   budget: {trials: n}       worlds: n | {first: i, count: n}       held_out: n | {first: i, count: n, seed: s}
///   confirm: none | {candidates, worlds, neighbours, radius}         racing: none | {first, block, significance}
///   sensitivity: none | {near, far, pairs_of}
///   controller: NAME   mixture: [{KEY: VALUE, ...}, ...]   seed, starts, output
/// `controllers`: names of the suite's controllers, in order. Throws config::ConfigError naming place and key.
TuneConfig read_tune(const config::Node& node, const std::vector<std::string>& controllers);

/// Throws config::ConfigError if the held-out worlds overlap the search's, for equal seeds. read_tune() calls this
/// unless held_out has a seed of its own.
void check_held_out(const TuneConfig& tune);

}  // namespace moma::tune
