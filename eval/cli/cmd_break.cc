#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/progress.h"
#include "eval/cli/rare_options.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/break.h"
#include "files/output_file.h"
#include "world/world_json.h"

namespace moma::cli {
namespace {

struct BreakOptions {
  SuiteOptions suite;
  run::BreakRequest request;
  std::string event = "collision";
  std::string worlds;
  Format format = Format::kTable;
  files::Replace replace = files::Replace::kOwn;
  bool quiet = false;
};

store::QueryResult table(const Suite& suite, const run::Broken& broken) {
  store::QueryResult out{{"line", "controller", "family", "world", "link", "object", "end s", "found by", "times"}, {}};
  for (const run::Failure& failure : broken.failures) {
    const SuitePoint& point = suite.points[failure.point];
    out.rows.push_back({static_cast<std::int64_t>(out.rows.size() + 1),
                        point.label.empty() ? point.controller : point.controller + ":" + point.label, failure.family,
                        static_cast<std::int64_t>(failure.world.index), failure.row.link, failure.row.object,
                        failure.row.time_end_s, failure.by, static_cast<std::int64_t>(failure.times)});
  }
  return out;
}

int break_suite(const BreakOptions& options) {
  const files::Kind kind{"file of worlds", ""};  // edited by hand: none is known for moma's own
  if (!options.worlds.empty()) files::check_replace(options.worlds, kind, options.replace);
  const Suite suite = options.suite.load();
  const run::RareEvent event = rare_event(options.event, "break");
  if (!options.quiet) print_warnings(suite.warnings);
  const InterruptGuard interrupt;
  run::BreakRequest request = options.request;
  request.trials.stop = &InterruptGuard::flag();
  StatusLine progress(options.quiet);
  const run::Broken broken = run::break_suite(request, suite, event, listener_on_stderr(options.quiet, progress));
  progress.clear();
  write(std::cout, table(suite, broken), options.format);
  std::cout.flush();
  if (!options.worlds.empty() && !broken.failures.empty()) {
    files::write_file(options.worlds, kind, options.replace, [&](std::ostream& out) {
      for (const run::Failure& failure : broken.failures) out << to_json(failure.world).dump() << '\n';
    });
    if (!options.quiet)
      std::cerr << fmt::format("to run them: the suite with --trials {} --set 'worlds={{frozen: {}}}'\n",
                               broken.failures.size(), terminal_safe(options.worlds));
  }
  if (broken.end == run::End::kFinished) return kOk;
  std::cerr << terminal_safe_lines(broken.stopped) << std::endl;
  return kStoppedEarly;
}

}  // namespace

void add_break(CLI::App& app, Action& action, const Arguments& arguments) {
  auto options = std::make_shared<BreakOptions>();
  options->request.trials.arguments = arguments;
  CLI::App* command =
      app.add_subcommand("break", "Find failures of a suite's controllers, the likeliest first, as frozen worlds");
  options->suite.add_to(*command);
  command->add_option("--worlds", options->worlds, "Write the worlds found there, for `worlds: {frozen: FILE}`");
  add_rare_event(*command, options->event);
  command->add_option("--crude", options->request.crude, "Trials of each family that are looked at first (1000)")
      ->check(CLI::Range(1, 100000000));
  command->add_option("--nearest", options->request.nearest, "Part of them whose noise is drawn again (0.01)")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--noises", options->request.noises, "Times (40)")->check(CLI::Range(0, 100000));
  add_splitting(*command, options->request.splitting);
  add_moved_trials_store(*command, options->request.trials.file);
  add_threads(*command, options->request.trials.threads);
  add_format(*command, options->format);
  add_force(*command, options->replace);
  command->add_flag("-q,--quiet", options->quiet, "No progress and no remarks");
  command->footer(
      "A failure is a robot shape against an object in a world: found among crude trials, by other noise where those\n"
      "came nearest, or by splitting. docs/how-to/rare-failures.md has more.\n"
      "Example: moma break configs/suites/mixed.yaml --worlds found.jsonl -o results/break.db");
  command->callback([&action, options] { action = [options] { return break_suite(*options); }; });
}

}  // namespace moma::cli
