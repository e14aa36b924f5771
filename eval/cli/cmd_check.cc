#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include "controller/config/node.h"
#include "controller/describe/enumeration.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/store_file.h"
#include "eval/run/survey.h"
#include "eval/run/warnings.h"
#include "eval/tune/tuned_file.h"
#include "eval/tune/tuning.h"

namespace moma::cli {
namespace {

std::string family_text(const Suite& suite) {
  return joined(run::family_counts(suite), [](const auto& of) { return fmt::format("{} {}", of.second, of.first); });
}

/// "2 controllers (a, b) x 3 sweep points", or where a sweep has some of them only, "4 points of 2 controllers (a 3, b
/// 1)".
std::string points_text(const Suite& suite) {
  std::map<std::string, std::size_t> points;
  for (const SuitePoint& point : suite.points) ++points[point.controller];
  const std::size_t each = points.begin()->second;
  const bool alike = std::ranges::all_of(points, [&](const auto& entry) { return entry.second == each; });
  const std::string names =
      joined(points, [&](const auto& of) { return alike ? of.first : fmt::format("{} {}", of.first, of.second); });
  const std::string controllers =
      fmt::format("{} controller{} ({})", points.size(), points.size() == 1 ? "" : "s", names);
  if (!alike) return fmt::format("{} points of {}", suite.points.size(), controllers);
  return controllers + (each > 1 ? fmt::format(" x {} sweep points", each) : std::string());
}

/// Warns about each robot: drives too weak for the arm (with physics), visuals larger than the collision shapes.
std::vector<std::string> robot_warnings(const Suite& suite, const fs::path& file) {
  std::vector<std::string> warnings;
  std::set<std::string> seen;
  const auto say = [&](const RobotModel& model, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) warnings.push_back(fmt::format("robot {}: {}", model.name, text));
  };
  for (const SuitePoint& point : suite.points) {
    const std::shared_ptr<const RobotModel>& model = point.robot->model;
    if (point.simulation.mode == SimulationMode::kDynamic && seen.insert(point.robot_digest + " physics").second)
      say(*model, run::holding_warnings(model));
    if (seen.insert(point.robot_digest).second) say(*model, run::wheel_warnings(*model));
  }
  const config::Node suite_file = config::load_yaml(file);
  const config::Node* robot = suite_file.find("robot");
  const std::shared_ptr<const RobotModel>& first = suite.points.front().robot->model;
  if (robot != nullptr && robot->kind == config::Node::Kind::kScalar && seen.size() <= 2)
    say(*first, run::visual_warnings(config::directory_of(robot->mark) / robot->scalar, *first));
  return warnings;
}

/// Predicts the duration of a run.
std::string expected_time(const Suite& suite, double enough, run::WorldSurvey& survey) {
  const run::TrialTime time = run::trial_time(suite, enough, survey);
  const int cores = run::usual_threads();
  const double all = static_cast<double>(suite.trials) * static_cast<double>(suite.points.size());
  return fmt::format("about {} on {} thread{} ({:.0f} ms a trial, from {} of them)",
                     duration_text(time.each * all / cores), cores, cores == 1 ? "" : "s", 1e3 * time.each,
                     time.measured);
}

using store::Cell;

Cell whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

/// Prints tables of world generation: tries, reasons of rejections and, with `times`, durations, which alone differ
/// from call to call. Prints nothing if no world was generated.
void print_survey(const run::WorldSurvey& survey, bool times) {
  if (survey.tallies().empty()) return;
  store::QueryResult made{
      {"robot", "family", "worlds", "tries each", "us each", "trials", "ms a trial", "% of a trial"}, {}};
  store::QueryResult reasons{{"robot", "family", "rejected", "of %", "because"}, {}};
  std::set<std::string> robots;
  for (const auto& [place, tally] : survey.tallies()) {
    const auto& [robot, family] = place;
    robots.insert(robot);
    const auto worlds = static_cast<double>(std::max<std::uint64_t>(1, tally.log.worlds));
    const double each = tally.seconds / worlds;
    const double trial = tally.trials > 0 ? tally.trial_seconds / static_cast<double>(tally.trials) : kAbsent;
    made.rows.push_back({robot, family, whole(tally.log.worlds),
                         rounded(static_cast<double>(tally.log.tries) / worlds, 0.1), rounded(1e6 * each, 1.0),
                         whole(tally.trials), rounded(1e3 * trial, 0.1), rounded(100.0 * each / trial, 0.01)});
    // Most frequent first, those of equal count by name.
    std::vector<std::pair<std::string, std::uint64_t>> sorted(tally.log.rejections.begin(), tally.log.rejections.end());
    std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.second > b.second; });
    for (const auto& [why, count] : sorted)
      reasons.rows.push_back({robot, family, whole(count),
                              rounded(100.0 * static_cast<double>(count) / static_cast<double>(tally.log.tries), 0.1),
                              why});
    for (const auto& [why, count] : tally.log.redraws)
      reasons.rows.push_back({robot, family, whole(count), Cell{}, why + " (drawn again)"});
  }
  if (!times) drop_columns(made, 4, 8);
  if (robots.size() == 1) {  // the line above names it
    drop_columns(made, 0, 1);
    drop_columns(reasons, 0, 1);
  }
  write(std::cout, made, Format::kTable);
  if (!reasons.rows.empty()) {
    std::cout << '\n';
    write(std::cout, reasons, Format::kTable);
  }
  std::cout << '\n';
}

struct CheckOptions {
  SuiteOptions suite;
  bool no_time = false;
  double seconds = 1.0;
  std::uint64_t worlds = 100;
};

int check(const CheckOptions& check_options) {
  const SuiteOptions& options = check_options.suite;
  const Suite suite = options.load();
  (void)run::finishing(suite);  // refuses metrics that a run would refuse
  const SuitePoint& first = suite.points.front();
  std::cout << terminal_safe(fmt::format("{}: {}{} trials = {} worlds x {}", suite.name, suite.until ? "at most " : "",
                                         suite.trials * suite.points.size(), suite.trials, points_text(suite)))
            << '\n'
            << terminal_safe(fmt::format("robot {}, {} mode, worlds: {} (seed {})", first.robot->model->name,
                                         to_string(first.simulation.mode), family_text(suite), first.worlds.seed()))
            << std::endl;
  const auto disturbed =
      std::ranges::count_if(suite.points, [](const SuitePoint& point) { return any(point.disturbances); });
  if (disturbed == static_cast<std::ptrdiff_t>(suite.points.size())) {
    std::cout << "sensors and drives are disturbed\n";
  } else if (disturbed > 0) {
    std::cout << fmt::format("sensors and drives are disturbed in {} of {} points\n", disturbed, suite.points.size());
  }
  // The first world shows whether this robot has a place in these worlds at all.
  (void)first.worlds.make(first.robot->model, 0);
  run::WorldSurvey survey;
  survey.make_worlds(suite.points, check_options.worlds, suite.trials);
  std::string time;
  if (!check_options.no_time) time = expected_time(suite, check_options.seconds, survey) + '\n';
  std::cout << '\n';
  print_survey(survey, !check_options.no_time);
  std::cout << time;
  std::vector<std::string> warnings = suite.warnings;
  for (const auto& more : {survey.failures(), robot_warnings(suite, options.file), survey.doubts()})
    warnings.insert(warnings.end(), more.begin(), more.end());
  print_warnings(warnings);
  if (config::load_yaml(options.file).find("tune") != nullptr) {
    const tune::Tuning tuning = tune::load_tuning(options.file, options.overrides());
    print_warnings(tuning.warnings);
    std::cout << tune::plan_text(tuning) << '\n';
  }
  std::cout << (warnings.empty() ? "no warnings\n"
                                 : fmt::format("{} warning{}\n", warnings.size(), warnings.size() == 1 ? "" : "s"));
  return kOk;
}

}  // namespace

void add_check(Commands& commands) {
  auto [command, options] = commands.add<CheckOptions>("check", "Validate a suite without running it", &check);
  options.suite.add_to(command);
  command.add_flag("--no-time", options.no_time, "Runs no trials to estimate the duration of a run");
  command.add_option("--seconds", options.seconds, "Duration of the trials that estimate the duration of a run")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command
      .add_option("--worlds", options.worlds, "Number of worlds to generate, for rates and reasons of rejected tries")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command.footer("Example: moma check configs/suites/demo.yaml");
}

}  // namespace moma::cli
