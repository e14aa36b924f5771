#include "eval/tune/stored_search.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "eval/suite/resolve.h"

namespace moma::tune {
namespace {

Phase phase_of(const std::string& text) {
  if (const auto phase = from_string<Phase>(text)) return *phase;
  throw ReplayError("stored evaluation of an unknown phase '" + text + "': it was made by another version of moma");
}

}  // namespace

void StoredTrials::add(const SuitePoint& point, std::uint64_t world_index, const std::string& key, const World* world,
                       const TrialRow& row) {
  const store::WorldRecord record =
      world != nullptr ? store::describe(*world) : store::describe_missing(point.worlds, world_index);
  writer_.add({store::kNoPoint, world_index, key}, record, row, nullptr);
}

std::optional<Evaluation> StoredLog::find(std::uint64_t index) {
  std::optional<store::TuneEvaluationRecord> r = records_.find(index);
  if (!r) return std::nullopt;
  Evaluation e;
  e.index = r->evaluation;
  e.phase = phase_of(r->phase);
  e.run = r->run;
  e.candidate = std::move(r->candidate);
  e.first = static_cast<std::size_t>(r->first_world);
  e.measured = std::move(r->measured);
  e.worlds = static_cast<std::size_t>(r->worlds);
  e.cut = r->cut;
  e.valid = r->valid;
  e.cost = r->cost;
  e.merit = r->merit;
  e.constraints = std::move(r->constraints);
  return e;
}

void StoredLog::append(const Evaluation& e) {
  store::TuneEvaluationRecord r;
  r.evaluation = e.index;
  r.phase = to_string(e.phase);
  r.run = e.run;
  r.candidate = e.candidate;
  r.first_world = e.first;
  r.worlds = e.worlds;
  r.cut = e.cut;
  r.valid = e.valid;
  r.cost = e.cost;
  r.merit = e.merit;
  r.constraints = e.constraints;
  r.measured = e.measured;
  records_.append(r);
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

store::TuneSearchRecord search_record(const Tuning& tuning) {
  store::TuneSearchRecord record;
  record.suite = tuning.suites.front().name;
  record.controller = tuning.config.controller;
  record.identity = tuning.identity.dump();
  record.objective = objective_text(tuning);
  record.unit = tuning.config.cost.unit();
  record.budget_trials = tuning.config.budget;
  for (const Variable& v : tuning.config.variables) {
    record.variables.push_back(
        {v.key, v.lower, v.upper, std::string(to_string(v.scale)), v.start, std::nullopt, std::nullopt});
  }
  return record;
}

store::TuneResultRecord result_record(const SearchResult& result) {
  store::TuneResultRecord record;
  record.found = result.found;
  record.importance = result.importance;
  record.trials = result.trials;
  record.trials_saved = result.trials_saved;
  record.evaluations_cut = result.evaluations_cut;
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  for (const RunNote& run : result.runs) {
    runs.push_back({{"algorithm", run.algorithm},
                    {"start", run.start},
                    {"trials", run.trials},
                    {"evaluations", run.evaluations},
                    {"end", run.end}});
  }
  record.runs = runs.dump();
  record.notes = nlohmann::ordered_json(result.notes).dump();
  for (const Finalist& f : result.finalists) {
    record.finalists.push_back({f.candidate, f.search_merit, f.merit, f.neighbours, f.robust, f.worlds});
  }
  for (const SensitivityStep& s : result.sensitivity.steps) {
    record.sensitivity.push_back({static_cast<int>(s.variable), std::nullopt, s.value, s.change, s.error, s.valid});
  }
  for (const SensitivityPair& s : result.sensitivity.pairs) {
    record.sensitivity.push_back(
        {static_cast<int>(s.first), static_cast<int>(s.second), std::nullopt, s.interaction, s.error, true});
  }
  return record;
}

Suite searched_suite(const Tuning& tuning) {
  Suite suite = tuning.suites.front();
  suite.points = {suite.points[tuning.tuned_point.front()]};
  suite.resolved = resolved_json(suite, false);
  return suite;
}

}  // namespace moma::tune
