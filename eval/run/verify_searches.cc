#include "eval/run/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <optional>
#include <stdexcept>

#include "controller/config/json_node.h"
#include "eval/store/columns.h"
#include "eval/store/search_tables.h"
#include "eval/store/table.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "eval/trial/key.h"
#include "eval/tune/held_out.h"
#include "eval/tune/search_record.h"
#include "eval/tune/trial_objective.h"
#include "eval/tune/tuning.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

using Robots = std::map<std::string, Json>;  // resolved ones by their digests

/// Exception at the end of the stored evaluations.
struct Ended {};

struct Check {
  const store::Reader& reader;
  const VerifyRequest& request;
  const std::set<std::string>& chosen;  ///< trials that are computed again
  const Listener::Text& finding;
  Verification& found;
};

/// A source of stored rows. It withholds those of the chosen trials, so that they are simulated again; add() compares.
class Trials : public TrialSource {
 public:
  explicit Trials(const Check& check) : check_(check) {}

  std::optional<TrialRow> find(const std::string& key) override {
    met_.insert(key);
    if (check_.chosen.contains(key) && !compared_.contains(key)) return std::nullopt;
    return stored(key).row;
  }
  void add(const SuitePoint& /*point*/, const BatchJob& job, const BatchResult& result) override {
    const std::string& key = job.key;
    const TrialRow& row = result.output.row;
    const World* const world = result.world.get();
    const store::LoneTrial kept = stored(key);
    std::vector<std::string> lines = differences(kept.row, kept.machine_class, row).lines;
    for (const std::string_view column : store::missing_columns(kept.row, row)) ++check_.found.missing[column];
    const auto json = config::parse_json(kept.world, "world");
    const bool missing = json.contains("missing");
    const bool same = world == nullptr || missing
                          ? world == nullptr && missing
                          : to_json(world_from_json(json, "world")).dump() == to_json(*world).dump();
    if (!same) lines.emplace_back("its world is not the one that its search draws");
    if (!lines.empty())
      check_.finding(fmt::format("trial {}, of a search: {}", key.substr(0, 16), fmt::join(lines, "; ")));
    compared_.insert(key);
  }
  std::size_t compared() const { return compared_.size(); }
  bool met(const std::string& key) const { return met_.contains(key); }

 private:
  store::LoneTrial stored(const std::string& key) const {
    std::optional<store::LoneTrial> trial = check_.reader.lone_trial(key);
    if (!trial) throw std::runtime_error(fmt::format("trial {} is missing", key.substr(0, 16)));
    return std::move(*trial);
  }

  const Check& check_;
  std::set<std::string> met_, compared_;
};

/// A log that withholds its evaluations, so that the search measures each again; append() compares.
class Log : public tune::EvaluationLog {
 public:
  explicit Log(const std::vector<tune::Evaluation>& stored) : stored_(stored) {}
  std::optional<tune::Evaluation> find(std::uint64_t index) override {
    if (index >= stored_.size()) throw Ended{};
    return std::nullopt;
  }
  void append(const tune::Evaluation& evaluation) override {
    const std::string differ = store::differing_columns(stored_.at(evaluation.index), evaluation);
    if (!differ.empty())
      throw std::runtime_error(
          fmt::format("tune_evaluation {}: {} not as the search and its trials give", evaluation.index, differ));
    appended_ = evaluation.index + 1;
  }
  std::uint64_t appended() const { return appended_; }

 private:
  const std::vector<tune::Evaluation>& stored_;
  std::uint64_t appended_ = 0;
};

class Search {
 public:
  Search(const Check& check, Trials& trials, const store::StoredSearch& stored, std::int64_t id)
      : check_(check),
        trials_(trials),
        stored_(stored),
        name_(fmt::format("search {} ({} of {})", id, stored.record.controller, stored.record.suite)) {}

  void execute(const Robots& robots) {
    std::optional<tune::Tuning> tuning;
    attempt("tune_search: ", [&] { tuning = make_tuning(robots); });
    if (!tuning) return;
    attempt("", [&] { run(*tuning); });
    if (check_.found.end == End::kFinished) attempt("", [&] { judge(*tuning); });
  }

 private:
  void complain(const std::string& text) const { check_.finding(fmt::format("{}: {}", name_, text)); }
  void doubt(const std::string& text) const { check_.found.in_doubt.push_back(fmt::format("{}: {}", name_, text)); }

  /// Reports any exception as a finding: a changed store can hold nearly anything.
  template <class Work>
  void attempt(const char* of, const Work& work) const {
    try {
      work();
    } catch (const store::StoreError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      complain(of + std::string(error.what()));
    }
  }

  template <class R>
  void compare(const std::string& table, const R& kept, const R& said) const {
    const std::string differ = store::differing_columns(kept, said);
    if (!differ.empty()) complain(fmt::format("{}: {} not as the search and its trials give", table, differ));
  }
  template <class R>
  void compare(const char* table, const std::vector<R>& kept, const std::vector<R>& said) const {
    if (kept.size() != said.size())
      complain(fmt::format("{}: {} rows, and its trials give {}", table, kept.size(), said.size()));
    for (std::size_t i = 0; i < std::min(kept.size(), said.size()); ++i)
      compare(fmt::format("{}, row {}", table, i), kept[i], said[i]);
  }

  std::optional<tune::Tuning> make_tuning(const Robots& robots) const {
    const store::TuneSearchRecord& kept = stored_.record;
    const auto parsed = [](const std::string& text, const char* column) { return config::parse_json(text, column); };
    try {
      return tune::stored_tuning(parsed(kept.identity, "tune_search.identity"),
                                 kept.held_out ? parsed(*kept.held_out, "tune_search.held_out") : Json(), robots,
                                 check_.request.plugins);
    } catch (const tune::NotStored& why) {
      doubt(fmt::format("cannot be run again: {}", why.what()));
    } catch (const PluginRefused&) {
      doubt("is of a suite with a plugin (--allow-plugins loads it)");
    }
    return std::nullopt;
  }

  void run(const tune::Tuning& tuning) {
    const store::TuneSearchRecord& kept = stored_.record;
    const bool ended = kept.status == tune::SearchStatus::kFinished || !stored_.finalists.empty();
    Log log(stored_.evaluations);
    tune::TrialObjective objective(tuning, trials_, check_.request.threads, check_.request.stop);
    std::optional<tune::SearchResult> result;
    try {
      result = tune::search(tune::search_settings(tuning), objective, log);
    } catch (const Ended&) {
      if (ended)
        throw std::runtime_error(
            fmt::format("tune_evaluation: the search has an end, and evaluation {} is missing", log.appended()));
    } catch (const Interrupted& why) {
      const std::string late = why.what();
      if (!late.empty()) return doubt(late);
      check_.found.end = End::kStopped;
      return;
    }
    ++check_.found.searches;
    if (log.appended() < stored_.evaluations.size())
      complain(fmt::format("tune_evaluation: {} rows, and the search ends after {}", stored_.evaluations.size(),
                           log.appended()));
    store::TuneSearchRecord said = tune::search_record(tuning);
    said.hash = kept.hash, said.started = kept.started, said.ended = kept.ended, said.status = kept.status;
    said.held_out_suite = kept.held_out_suite, said.held_out = kept.held_out, said.verdict = kept.verdict;
    std::vector<store::TuneVariableRecord> variables;
    for (const tune::Variable& variable : tuning.config.variables) variables.push_back({variable, {}, {}});
    if (ended) {
      store::add_result(said, *result);
      store::add_result(variables, *result);
      compare("tune_finalist", stored_.finalists, result->finalists);
      compare("tune_sensitivity", stored_.sensitivity, store::sensitivity_records(result->sensitivity));
    }
    compare("tune_search", kept, said);
    compare("tune_variable", stored_.variables, variables);
  }

  /// The verdict on the held-out worlds, from the stored trials.
  void judge(const tune::Tuning& tuning) {
    const store::TuneSearchRecord& kept = stored_.record;
    const bool any = kept.verdict || kept.held_out_suite || !stored_.comparisons.empty();
    if (!any && !kept.held_out) return;  // none was asked for
    if (!kept.held_out)
      return doubt(
          "tune_search.held_out is empty: the moma that judged it did not keep its worlds (moma tune, on this store "
          "again, judges it anew from the stored trials)");
    tune::Candidate gains;
    for (const store::TuneVariableRecord& variable : stored_.variables)
      if (variable.found) gains.push_back(*variable.found);
    if (!kept.verdict || !kept.held_out_suite || gains.size() != tuning.config.variables.size())
      throw std::runtime_error("tune_search: it has a part of a verdict");
    const tune::HeldOut held_out = tune::make_held_out(tuning, gains);
    const std::vector<std::string> in_suite = check_.reader.keys_of_suite(*kept.held_out_suite);
    std::vector<TrialRow> rows;
    for (const BatchJob& job : held_out.jobs) {
      std::optional<store::LoneTrial> trial;
      if (std::binary_search(in_suite.begin(), in_suite.end(), job.key)) trial = check_.reader.lone_trial(job.key);
      if (!trial)
        throw std::runtime_error(fmt::format("tune_search: suite {} has no trial of {} in world {}",
                                             *kept.held_out_suite, held_out.suite.points[job.point].controller,
                                             job.world));
      rows.push_back(std::move(trial->row));
    }
    const tune::HeldOutVerdict verdict = tune::judge(tuning, held_out, rows);
    ++check_.found.verdicts;
    compare("tune_comparison", stored_.comparisons, verdict.rows);
    if (verdict.overall != *kept.verdict)
      complain(fmt::format("tune_search: verdict '{}', and its trials give '{}'", to_string(*kept.verdict),
                           to_string(verdict.overall)));
  }

  const Check& check_;
  Trials& trials_;
  const store::StoredSearch& stored_;
  std::string name_;
};

Robots robots_of(const store::Reader& reader) {
  Robots robots;
  for (const std::string& text : reader.robots()) {
    try {
      Json robot = config::parse_json(text, "robot");
      robots.emplace(canonical_digest(robot), std::move(robot));
    } catch (const std::runtime_error&) {  // told by check_contents()
    }
  }
  return robots;
}

}  // namespace

void verify_searches(const store::Reader& reader, const VerifyRequest& request, const std::set<std::string>& chosen,
                     const Listener::Text& finding, Verification& found) {
  const Check check{reader, request, chosen, finding, found};
  const std::vector<std::int64_t> ids = reader.searches();
  const Robots robots = ids.empty() ? Robots{} : robots_of(reader);
  Trials trials(check);
  for (const std::int64_t id : ids) {
    if (found.end != End::kFinished) break;
    try {
      const store::StoredSearch stored = reader.search(id);
      Search(check, trials, stored, id).execute(robots);
    } catch (const store::StoreError& error) {
      if (error.kind() != store::StoreError::Kind::kUnusable) throw;
      finding(fmt::format("search {}: {}", id, error.what()));
    }
  }
  found.chosen += trials.compared();
  found.replayed += trials.compared();
  const std::vector<std::string> keys = reader.searched_keys();
  const auto left = std::ranges::count_if(keys, [&](const std::string& key) { return !trials.met(key); });
  if (left > 0)
    found.not_checked.push_back(
        fmt::format("{} trials that belong to no point, nor to a search that was run again", left));
}

}  // namespace moma::run
