#include "eval/run/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "eval/batch/batch.h"
#include "eval/run/named_point.h"
#include "eval/run/store_file.h"
#include "eval/store/columns.h"
#include "eval/store/hash.h"
#include "eval/store/records.h"
#include "eval/store/run_lock.h"
#include "eval/store/samples.h"
#include "eval/store/user_metrics.h"
#include "eval/trial/key.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

/// The `fraction` of the keys that come first when all are ordered by a hash with the seed; at least one.
std::vector<std::string> choose(const std::vector<std::string>& keys, double fraction, std::int64_t seed) {
  const auto wanted = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(keys.size())));
  std::map<store::Hash, std::string> ordered;
  for (const std::string& key : keys) ordered.emplace(store::hash_text(fmt::format("{} {}", seed, key)), key);
  std::vector<std::string> chosen;
  for (const auto& [hash, key] : ordered) {
    if (chosen.size() == wanted) break;
    chosen.push_back(key);
  }
  std::ranges::sort(chosen);
  return chosen;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

/// Names of the columns that differ from the replayed ones in any bit. A column that only one side has belongs to
/// another version of the controller's memory and is no difference.
std::vector<std::string> differing_columns(const store::EncodedSamples& stored, const Trace& replayed) {
  const store::SampleTable then = store::decode_table(stored);
  const store::SampleTable now = store::decode_table(store::encode_samples(replayed));
  std::vector<std::string> differ;
  for (std::size_t c = 0; c < then.names.size(); ++c) {
    const auto found = std::ranges::find(now.names, then.names[c]);
    if (found == now.names.end()) continue;
    const std::vector<double>& other = now.columns[static_cast<std::size_t>(found - now.names.begin())];
    const std::vector<double>& own = then.columns[c];
    if (!std::equal(own.begin(), own.end(), other.begin(), other.end(), same_bits)) differ.push_back(then.names[c]);
  }
  return differ;
}

/// Evaluators of the suites' own metrics, by robot and expressions: making one compiles SQL.
class Metrics {
 public:
  /// Sentences of those that do not come out as stored; what cannot be evaluated goes into `unable`.
  std::vector<std::string> differences(const std::vector<store::StoredMetric>& stored, const RobotModel& robot,
                                       const Trace& trace, std::set<std::string>& unable) {
    std::vector<std::string> lines;
    for (const store::StoredMetric& metric : stored) {
      const store::UserMetrics* evaluator = find(metric, robot, unable);
      if (evaluator == nullptr) continue;
      const double now = evaluator->evaluate(trace).front();
      if (!same_bits(now, metric.value))
        lines.push_back(fmt::format("metric {}: {:.17g} != {:.17g} (metric_value)", metric.name, metric.value, now));
    }
    return lines;
  }

 private:
  const store::UserMetrics* find(const store::StoredMetric& metric, const RobotModel& robot,
                                 std::set<std::string>& unable) {
    const auto key = std::make_pair(&robot, metric.expression);
    const auto found = evaluators_.find(key);
    if (found != evaluators_.end()) return found->second.get();
    std::unique_ptr<store::UserMetrics> made;
    try {
      made = std::make_unique<store::UserMetrics>(
          std::vector<std::pair<std::string, std::string>>{{metric.name, metric.expression}}, robot.num_joints(),
          robot.num_velocities());
    } catch (const store::MetricError& error) {
      unable.insert(fmt::format("metric {}: {}", metric.name, error.what()));
    }
    return evaluators_.emplace(key, std::move(made)).first->second.get();
  }

  std::map<std::pair<const RobotModel*, std::string>, std::unique_ptr<store::UserMetrics>> evaluators_;
};

class Verifier {
 public:
  Verifier(const VerifyRequest& request, const Listener& listener)
      : request_(request), listener_(listener), reader_(request.file), suites_(request.plugins) {}

  Verification execute() {
    for (const std::string& problem : reader_.integrity_problems()) complain("integrity: " + problem);
    found_.contents = store::check_contents(request_.file, [this](const std::string& text) { complain(text); });
    check_points();
    tell_running();
    const std::vector<std::string> keys = reader_.keys();
    const std::vector<std::string> searched = reader_.searched_keys();
    found_.trials = keys.size() + searched.size();
    const std::vector<std::string> chosen = choose(asked_for(keys), request_.fraction, request_.seed);
    found_.chosen = chosen.size();
    collect(chosen);
    if (replay()) found_.end = End::kStopped;
    if (found_.end == End::kFinished) {
      std::vector<std::string> again;
      if (request_.point.empty()) again = choose(searched, request_.fraction, request_.seed);
      verify_searches(
          reader_, request_, {again.begin(), again.end()}, [this](const std::string& text) { complain(text); }, found_);
    }
    found_.hash = reader_.result_hash();
    tell_unchecked();
    return found_;
  }

 private:
  void complain(const std::string& text) {
    ++found_.findings;
    listener_.warning(text);
  }

  std::vector<std::string> asked_for(const std::vector<std::string>& all) const {
    if (request_.point.empty()) return all;
    std::vector<std::string> keys;
    for (const store::PointTrial& trial :
         reader_.trials_of(named_point(request_.file, request_.point, request_.suite).id))
      keys.push_back(trial.key);
    return keys;
  }

  /// The stored point; null, with the reason counted, where it cannot be built. `of`: whose it is.
  const SuitePoint* build(const store::StoredPoint& stored, const std::string& of, bool again = false) {
    try {
      return &suites_.point_of(stored, of);
    } catch (const store::StoreError& error) {
      ++unbuilt_[error.kind() == store::StoreError::Kind::kNotFound
                     ? "of another version of the simulation (point.simulation_version)"
                     : "of points that their suites do not have (point.resolved_position)"];
    } catch (const PluginRefused&) {
      ++unbuilt_["of suites with a plugin (--allow-plugins loads it)"];
    } catch (const config::ConfigError& error) {
      if (!again) return build(stored, of, true);  // a fault that passes is none of the store's
      ++unbuilt_[fmt::format("of suites that cannot be read (resolved_suite: {})", error.what())];
    }
    return nullptr;
  }

  /// Every row of table point, and every trial's key, from the resolved suites.
  void check_points() {
    std::map<const Suite*, store::SuiteRecord> records;
    for (const store::StoredPoint& stored : reader_.points()) {
      const std::string name = fmt::format("point {} ({} of {})", stored.id, stored.controller, stored.suite);
      const SuitePoint* point = build(stored, name);
      const std::vector<store::PointTrial> trials = reader_.trials_of(stored.id);
      if (point == nullptr) {
        keys_unchecked_ += trials.size();
        continue;
      }
      ++found_.points;
      const Suite& suite = suites_.suite_of(stored, name);
      auto record = records.find(&suite);
      if (record == records.end()) record = records.emplace(&suite, store::describe(suite)).first;
      const std::string differ = reader_.point_differences(stored.id, record->second.points.at(stored.position));
      if (!differ.empty()) complain(fmt::format("{}: {} not as its resolved suite says", name, differ));
      const TrialKeys keys(*point);
      for (const store::PointTrial& trial : trials) {
        if (!has_key(keys, *point, trial))
          complain(fmt::format("trial {}: its content gives another key; it, or point_trial, was changed",
                               trial.key.substr(0, 16)));
      }
    }
    unbuilt_.clear();  // counted again by trials
  }

  static bool has_key(const TrialKeys& keys, const SuitePoint& point, const store::PointTrial& trial) {
    try {
      return keys.key(point.worlds.identity(trial.world_index)) == trial.key;
    } catch (const GenerationError&) {  // no suite has such a world
      return false;
    }
  }

  /// Turns the chosen trials into jobs of a batch over copies of their points.
  void collect(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
      store::StoredTrial trial = reader_.trial(key);
      const SuitePoint* point = build(trial, trial_name(trial));
      if (point == nullptr) continue;
      std::shared_ptr<const World> world;
      try {
        world = std::make_shared<const World>(world_of(trial));
      } catch (const store::StoreError& error) {
        if (error.kind() != store::StoreError::Kind::kNotFound) throw;
        ++unbuilt_["without a world"];
        continue;
      } catch (const config::ConfigError&) {  // told by check_contents()
        ++unbuilt_["of worlds that cannot be read"];
        continue;
      }
      // One point per trial: the batch hands worlds out by point and index, which need not be unique in a store.
      jobs_.push_back({points_.size(), trial.world_index, key});
      points_.push_back(*point);
      worlds_.push_back(std::move(world));
      trial.world.clear(), trial.resolved_suite.clear(), trial.samples.reset();  // large
      stored_.push_back(std::move(trial));
    }
  }

  bool replay() {
    std::vector<char> drawn(points_.size(), 1);  // not bool: written by several threads
    BatchOptions batch;
    batch.threads = request_.threads;
    batch.stop = request_.stop;
    batch.progress = listener_.progress;
    batch.world = [this](const SuitePoint& point, std::uint64_t) {
      return worlds_[static_cast<std::size_t>(&point - points_.data())];
    };
    batch.finish = [&](const SuitePoint& point, BatchResult& result) {
      const auto place = static_cast<std::size_t>(&point - points_.data());
      try {
        const World again = point.worlds.make(point.robot->model, jobs_[place].world);
        drawn[place] = to_json(again).dump() == to_json(*result.world).dump() ? 1 : 0;  // absent numbers are null there
      } catch (const GenerationError&) {
        drawn[place] = 0;
      }
    };
    const BatchSummary summary = run_batch(points_, jobs_, batch, [&](const BatchJob& job, BatchResult&& result) {
      ++found_.replayed;
      compare(job, result, drawn[job.point] != 0);
      return true;
    });
    listener_.progress_end();
    return summary.stopped;
  }

  void compare(const BatchJob& job, const BatchResult& result, bool drawn) {
    ReplayDifferences found = differences(stored_[job.point].row, stored_[job.point].machine_class, result.output.row);
    for (const std::string_view column : store::missing_columns(stored_[job.point].row, result.output.row))
      ++found_.missing[column];
    if (!drawn) found.lines.push_back("its world is not the one that its suite draws");
    try {
      if (const auto samples = reader_.samples(job.key)) {
        ++samples_compared_;
        const std::vector<std::string> differ = differing_columns(*samples, result.output.trace);
        if (!differ.empty()) found.lines.push_back(fmt::format("samples: {} differ", fmt::join(differ, ", ")));
      }
    } catch (const store::StoreError&) {
      throw;
    } catch (const std::runtime_error&) {  // damaged: told by check_contents()
    }
    const std::vector<std::string> metrics =
        metrics_.differences(reader_.metrics(job.key), *points_[job.point].robot->model, result.output.trace, unable_);
    found.lines.insert(found.lines.end(), metrics.begin(), metrics.end());
    if (found.lines.empty()) return;
    listener_.progress_end();
    complain(fmt::format("trial {}: {}{}", job.key.substr(0, 16), fmt::join(found.lines, "; "),
                         !found.stored_machine.empty() ? " (computed on a machine of another class)" : ""));
  }

  void tell_running() const {
    const bool at_work = store::RunLock::taken(request_.file);
    const std::vector<std::string> started = reader_.running();
    for (const std::string& when : started) {
      const bool last = &when == &started.back();
      listener_.notice(at_work && last ? fmt::format("the run of {} is at work", when)
                                       : no_end_text(when, store::RunLock::there(request_.file)));
    }
  }

  void tell_unchecked() {
    std::vector<std::string>& list = found_.not_checked;
    std::vector<std::string>& doubt = found_.in_doubt;
    if (found_.replayed < found_.trials)
      list.push_back(fmt::format("results of {} trials that were not replayed", found_.trials - found_.replayed));
    for (const auto& [why, n] : unbuilt_) doubt.push_back(fmt::format("{} chosen trials {}", n, why));
    if (keys_unchecked_ > 0)
      doubt.push_back(fmt::format("keys of {} trials whose points could not be built", keys_unchecked_));
    if (found_.contents.samples > samples_compared_)
      list.push_back(fmt::format("values of {} series of samples", found_.contents.samples - samples_compared_));
    if (const auto& views = found_.contents.foreign_views; !views.empty())
      doubt.push_back(
          fmt::format("views {}, which queries and reports read: another build of moma wrote to the store, and "
                      "they are not this one's",
                      fmt::join(views, ", ")));
    for (const std::string& text : unable_) doubt.push_back(text);
    for (const auto& [column, n] : found_.missing)
      doubt.push_back(
          fmt::format("trial.{}: {} trials have no value and come out with one: it was removed, or a moma stored "
                      "them that did not measure it",
                      column, n));
    list.push_back("how long trials took, and what invocations say of themselves and of the risk that they estimated");
  }

  const VerifyRequest& request_;
  const Listener& listener_;
  store::Reader reader_;
  StoredSuites suites_;
  Metrics metrics_;
  std::vector<SuitePoint> points_;
  std::vector<BatchJob> jobs_;
  std::vector<std::shared_ptr<const World>> worlds_;
  std::vector<store::StoredTrial> stored_;      ///< the chosen ones, without world, suite and samples
  std::map<std::string, std::size_t> unbuilt_;  ///< why trials or points could not be built
  std::size_t keys_unchecked_ = 0;
  std::size_t samples_compared_ = 0;
  std::set<std::string> unable_;
  Verification found_;
};

}  // namespace

Verification verify(const VerifyRequest& request, const Listener& listener) {
  return Verifier(request, listener).execute();
}

}  // namespace moma::run
