#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/run/tune.h"
#include "eval/tune/tuned_file.h"

namespace moma::cli {
namespace {

struct TuneOptions {
  SuiteOptions suite;
  run::TuneRequest request;
  bool quiet = false;
  bool no_verdict = false;
};

void print(const tune::Tuning& tuning, const tune::SearchResult& result) {
  const std::uint64_t all = result.trials + result.trials_saved;
  std::cout << fmt::format("{} candidates in {} trials; {} of them cut short, which saved {} trials ({:.0f} %)\n",
                           result.history.size(), result.trials, result.evaluations_cut, result.trials_saved,
                           all > 0 ? 100.0 * static_cast<double>(result.trials_saved) / static_cast<double>(all) : 0.0);
  std::cout << tune::gains_table(tuning, result);
  for (const std::string& line : result.notes) std::cout << "note: " << line << '\n';
  std::cout << std::endl;
}

void print(const tune::HeldOutVerdict& verdict) {
  std::cout << tune::table(verdict) << '\n';
  for (const std::string& line : verdict.constraints) std::cout << "constraint " << line << '\n';
  std::cout << fmt::format("On worlds that took no part in the search, the found gains against '{}': {}{}.\n",
                           verdict.against, to_string(verdict.overall),
                           verdict.why.empty() ? "" : fmt::format(" (by {})", verdict.why));
}

/// Progress of a search.
class TuneProgress {
 public:
  TuneProgress(StatusLine& line, std::string unit)
      : line_(line), unit_(std::move(unit)), begin_(std::chrono::steady_clock::now()) {}

  void trial_computed() {
    ++computed_;
    ++since_update_;
    line_.show([this] { return text(); });
  }

  void evaluation_ended(const tune::Progress& p) {
    if (at_.evaluations == 0 && p.last != nullptr) start_ = p.last->merit;
    if (p.phase == tune::Phase::kSensitivity && at_.phase != p.phase) searched_ = at_.trials;
    if (p.best != nullptr) best_ = p.best->merit;
    at_ = p;
    since_update_ = 0;
    line_.show([this] { return text(); });
  }

 private:
  std::string text() const {
    const bool after = at_.phase == tune::Phase::kSensitivity;
    const std::uint64_t done = at_.trials + since_update_;
    std::string text = after ? fmt::format("sensitivity: {} trials after the search", done - searched_)
                             : fmt::format("{}: {} of {} trials", to_string(at_.phase), done, at_.budget);
    if (at_.evaluations > 0) {
      text += fmt::format(", {} candidates ({} cut short), best {:.4g}{} (start {:.4g})", at_.evaluations, at_.cut,
                          best_, unit_.empty() ? "" : " " + unit_, start_);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    if (computed_ > 0 && seconds > 0.0) {
      const double rate = static_cast<double>(computed_) / seconds;
      text += fmt::format(", {:.1f}/s", rate);
      if (!after && at_.budget > done)
        text += fmt::format(", {} left", duration_text(static_cast<double>(at_.budget - done) / rate));
    }
    return text;
  }

  StatusLine& line_;
  std::string unit_;
  std::chrono::steady_clock::time_point begin_;
  tune::Progress at_;
  std::uint64_t computed_ = 0, since_update_ = 0, searched_ = 0;
  double start_ = 0.0, best_ = 0.0;
};

int tune_suite(const TuneOptions& options) {
  if (is_database(options.suite.file)) {
    throw UsageError(fmt::format("{}: is a store, not a suite file", options.suite.file));
  }
  const tune::Tuning tuning = tune::load_tuning(options.suite.file, options.suite.overrides());
  if (!options.quiet) print_warnings(tuning.warnings);
  run::TuneRequest request = options.request;
  request.verdict = !options.no_verdict;
  Computation computation(request, options.quiet);
  TuneProgress search(computation.line(), tuning.config.cost.unit());
  run::TuneListener listener{computation.listener()};
  listener.trial = [&] { search.trial_computed(); };
  listener.evaluation = [&](const tune::Progress& progress) { search.evaluation_ended(progress); };
  listener.judged = [](const tune::HeldOutVerdict& verdict) { print(verdict); };
  listener.searched = [&](const tune::SearchResult& result) { print(tuning, result); };
  const run::Tuned tuned = run::tune(request, tuning, listener);
  if (const int code = tell_end(tuned); code != kOk) return code;
  if (tuned.gains.empty()) {
    std::cout << "the search found nothing better than the gains that it began with: no gains are written\n";
    return kOk;
  }
  const bool worse = tuned.verdict && tuned.verdict->overall == tune::Verdict::kWorse;
  std::cout << fmt::format("the found gains are in {}{}\n", tuned.gains.string(),
                           worse ? ", under a name of their own, since they are worse" : "");
  return kOk;
}

}  // namespace

void add_tune(Commands& commands) {
  auto [command, options] = commands.add<TuneOptions>(
      "tune", "Search the gains of a suite's controller with NLopt, and judge them on other worlds", &tune_suite);
  options.suite.add_to(command);
  add_output_store(command, options.request.file);
  command.add_option("--gains", options.request.gains,
                     "File for the found gains (configs/controllers/CONTROLLER-tuned.yaml)");
  add_force(command, options.request.replace);
  add_threads(command, options.request.threads);
  command.add_flag("--no-verdict", options.no_verdict, "Search only; the same command without it judges later");
  add_quiet(command, options.quiet);
  command.footer(
      "The suite's `tune` section names variables, objective, algorithm, budget and worlds: docs/reference/tuning.md.\n"
      "Every evaluation is stored: the same command goes on after a stop, and ends with the same gains.\n"
      "Example: moma tune configs/suites/tune-frankie.yaml --set tune.budget.trials=5000");
}

}  // namespace moma::cli
