#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/describe/describe.h"
#include "eval/search/search.h"
#include "eval/store/field.h"

// Tables tune_* of the store: the records of a search (eval/search), and rows that are made of them.

namespace moma::store {

struct TuneSearchRecord {
  Hash hash{};
  std::string suite;
  std::string controller;
  std::string identity;
  std::string objective;
  std::string unit;
  std::uint64_t budget_trials = 0;
  std::string started;
  std::optional<std::string> ended;
  tune::SearchStatus status = tune::SearchStatus::kRunning;
  std::optional<std::uint64_t> trials, trials_saved, evaluations_cut;
  std::optional<std::string> held_out_suite;
  std::optional<tune::Verdict> verdict;
  std::optional<std::string> runs, notes;
  std::optional<std::string> held_out;
};

constexpr void describe(auto& v, Of<TuneSearchRecord>) {
  using T = TuneSearchRecord;
  v.member("hash", &T::hash, Field{.text = "XXH3-128 of `identity`", .rule = "UNIQUE"});
  v.member("suite", &T::suite, Field{});
  v.member("controller", &T::controller, Field{});
  v.member("identity", &T::identity, Field{.text = "all that decides the search's path", .json = true});
  v.member("objective", &T::objective, Field{.text = "in words"});
  v.member("unit", &T::unit, Field{});
  v.member("budget_trials", &T::budget_trials, Field{});
  v.member("started", &T::started, Field{.text = "UTC, ISO 8601"});
  v.member("ended", &T::ended, Field{});
  v.member("status", &T::status, Field{});
  v.member("trials", &T::trials, Field{.text = "measured by search and confirmation"});
  v.member("trials_saved", &T::trials_saved, Field{.text = "by cutting candidates short"});
  v.member("evaluations_cut", &T::evaluations_cut, Field{});
  v.member("held_out_suite", &T::held_out_suite, Field{.text = "as shown in v_trials"});
  v.member("verdict", &T::verdict, Field{});
  v.member("runs", &T::runs, Field{.text = "NLopt's runs: algorithm, trials, why it ended", .json = true});
  v.member("notes", &T::notes, Field{.json = true});
  v.member("held_out", &T::held_out,
           Field{.text = "worlds of the verdict: first, count, seed if another", .json = true});
}

struct TuneVariableRecord : tune::Variable {
  std::optional<double> found;
  std::optional<double> importance;
};

constexpr void describe(auto& v, Of<TuneVariableRecord>) {
  using T = TuneVariableRecord;
  v.member("key", &T::key, Field{});
  v.member("lower", &T::lower, Field{});
  v.member("upper", &T::upper, Field{});
  v.member("scale", &T::scale, Field{});
  v.member("start", &T::start, Field{});
  v.member("found", &T::found, Field{});
  v.member("importance", &T::importance, Field{.text = "share of the variance over the search"});
}

/// A step of one gain, or of two together.
struct TuneSensitivityRecord {
  std::size_t variable = 0;
  std::optional<std::size_t> other;
  std::optional<double> value;
  double change = 0.0, error = 0.0;
  bool valid = true;
};

constexpr void describe(auto& v, Of<TuneSensitivityRecord>) {
  using T = TuneSensitivityRecord;
  v.member("variable", &T::variable, Field{});
  v.member("other", &T::other, Field{});
  v.member("value", &T::value, Field{.text = "the gain's; NULL for pairs"});
  v.member("change", &T::change, Field{});
  v.member("error", &T::error, Field{.text = "standard error"});
  v.member("valid", &T::valid, Field{});
}

struct TuneComparisonRecord {
  std::string family, other, metric;
  std::int64_t n = 0;
  double found = 0.0, found_low = 0.0, found_high = 0.0;  ///< NaN: NULL
  double theirs = 0.0, theirs_low = 0.0, theirs_high = 0.0;
  double difference = 0.0, difference_low = 0.0, difference_high = 0.0;
  double p = 0.0;
  tune::Verdict verdict = tune::Verdict::kNoDifference;
};

constexpr void describe(auto& v, Of<TuneComparisonRecord>) {
  using T = TuneComparisonRecord;
  v.member("family", &T::family, Field{.text = "'all': every family together"});
  v.member("other", &T::other, Field{.text = "the controller compared with"});
  v.member("metric", &T::metric, Field{});
  v.member("n", &T::n, Field{.text = "worlds compared"});
  v.member("found", &T::found, Column{.text = "rate or mean"});
  v.member("found_low", &T::found_low, Column{});
  v.member("found_high", &T::found_high, Column{});
  v.member("theirs", &T::theirs, Column{});
  v.member("theirs_low", &T::theirs_low, Column{});
  v.member("theirs_high", &T::theirs_high, Column{});
  v.member("difference", &T::difference, Column{.text = "found - theirs, paired"});
  v.member("difference_low", &T::difference_low, Column{});
  v.member("difference_high", &T::difference_high, Column{});
  v.member("p", &T::p, Column{.text = "exact McNemar with Holm's correction; NULL for means"});
  v.member("verdict", &T::verdict, Field{});
}

/// All rows of a search.
struct StoredSearch {
  TuneSearchRecord record;
  std::vector<TuneVariableRecord> variables;
  std::vector<tune::Evaluation> evaluations;
  std::vector<tune::Finalist> finalists;
  std::vector<TuneSensitivityRecord> sensitivity;
  std::vector<TuneComparisonRecord> comparisons;
};

}  // namespace moma::store

namespace moma::tune {

constexpr void describe(auto& v, Of<Evaluation>) {
  using store::Field;
  using T = Evaluation;
  v.member("evaluation", &T::index, Field{.text = "from 0"});
  v.member("phase", &T::phase, Field{});
  v.member("run", &T::run, Field{});
  v.member("candidate", &T::candidate, Field{.text = "values in the order of tune_variable"});
  v.member("first_world", &T::first, Field{.text = "worlds known before, of the search's order"});
  v.member("worlds", &T::worlds, Field{.text = "known after"});
  v.member("cut", &T::cut, Field{});
  v.member("valid", &T::valid, Field{});
  v.member("cost", &T::cost, Field{});
  v.member("merit", &T::merit, Field{.text = "cost and penalty; an estimate where cut"});
  v.member("constraints", &T::constraints, Field{});
  v.member("measured", &T::measured, Field{.text = "cost and constraints per world", .bits = true});
}

constexpr void describe(auto& v, Of<Finalist>) {
  using store::Field;
  using T = Finalist;
  v.member("candidate", &T::candidate, Field{});
  v.member("search_merit", &T::search_merit, Field{});
  v.member("merit", &T::merit, Field{});
  v.member("neighbours", &T::neighbours, Field{.text = "mean merit around it"});
  v.member("robust", &T::robust, Field{});
  v.member("worlds", &T::worlds, Field{});
}

}  // namespace moma::tune
