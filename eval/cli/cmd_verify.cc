#include <fmt/format.h>

#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/verify.h"

namespace moma::cli {
namespace {

struct VerifyOptions {
  run::VerifyRequest request;
  bool hash = false;
  bool quiet = false;
};

std::string verdict(const run::Verification& found) {
  if (found.findings > 0) return fmt::format("{} findings", found.findings);
  if (found.in_vain())
    return fmt::format("none of the {} chosen ones can be, so that nothing is known of the results", found.chosen);
  if (!found.in_doubt.empty())
    return fmt::format("no findings, but not all could be checked: {}", found.in_doubt.front());
  if (found.replayed == 0) return "nothing is known of the results; all else is sound";
  if (found.replayed < found.trials)
    return "all the same, bit for bit; of the other results nothing is known, all else is sound";
  return "all the same, bit for bit; the store is sound";
}

int verify(const VerifyOptions& options) {
  run::VerifyRequest request = options.request;
  const Computation computation(request, options.quiet);
  run::Listener listener = computation.listener();
  listener.warning = [](const std::string& finding) { std::cerr << terminal_safe(finding) << '\n'; };
  const run::Verification found = run::verify(request, listener);
  std::cout << fmt::format("{} of {} trials replayed: {}\n", found.replayed, found.trials, verdict(found));
  if (!options.quiet) {
    std::cout << fmt::format(
        "compared: {} hashes, {} worlds, {} points with their suites, {} copies of trials, {} series "
        "of samples unpacked\n",
        found.contents.hashes, found.contents.worlds, found.points, found.contents.copies, found.contents.samples);
    if (found.searches > 0)
      std::cout << fmt::format("run again from stored trials: {} searches; judged again: {} verdicts\n", found.searches,
                               found.verdicts);
    for (const std::string& text : found.in_doubt) std::cout << "could not be checked: " << terminal_safe(text) << '\n';
    for (const std::string& text : found.not_checked) std::cout << "not checked: " << terminal_safe(text) << '\n';
  }
  if (options.hash) std::cout << fmt::format("results {}\ntables {}\n", found.hash, found.contents.table_hash);
  if (found.end != run::End::kFinished) return kStoppedEarly;
  return found.findings == 0 && found.in_doubt.empty() && !found.in_vain() ? kOk : kCheckFailed;
}

}  // namespace

void add_verify(Commands& commands) {
  auto [command, options] =
      commands.add<VerifyOptions>("verify", "Replay a fraction of a store's trials and check its integrity", &verify);
  add_store(command, options.request.file);
  command.add_option("--fraction", options.request.fraction, "Fraction of the trials to replay (0.1)")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--seed", options.request.seed, "Chooses other trials");
  command.add_option("--point", options.request.point,
                     "Replays trials of this controller alone: as in `moma compare`, @best too");
  command.add_option("--suite", options.request.suite, "Suite, if several have it");
  add_threads(command, options.request.threads);
  add_allow_plugins(command, options.request.plugins);
  command.add_flag("--hash", options.hash, "Print one hash over all results: equal hashes mean equal rows");
  add_quiet(command, options.quiet);
  command.footer(
      "Compares what the store says twice, and every hash; runs searches again over their stored trials; says what\n"
      "it did not look at. Exit 1 where a trial differs, the store is damaged, or what was to be checked cannot be\n"
      "(another simulation's trials, views of another build, metrics that SQLite refuses).\n"
      "Example: moma verify results/demo.db --fraction 0.05 --hash");
}

}  // namespace moma::cli
