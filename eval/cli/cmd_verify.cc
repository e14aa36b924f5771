#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/listener.h"
#include "eval/cli/progress.h"
#include "eval/cli/table.h"
#include "eval/run/verify.h"

namespace moma::cli {
namespace {

struct VerifyOptions {
  run::VerifyRequest request;
  bool hash = false;
  bool quiet = false;
};

int verify(const VerifyOptions& options) {
  const InterruptGuard interrupt;
  ProgressPrinter progress(options.quiet, "success");
  run::Listener listener = listener_on_stderr(options.quiet, &progress);
  listener.warning = [](const std::string& finding) { std::cerr << terminal_safe(finding) << '\n'; };
  run::VerifyRequest request = options.request;
  request.stop = &InterruptGuard::flag();
  const run::Verification found = run::verify(request, listener);
  std::cout << fmt::format("{} of {} trials replayed{}: {}\n", found.replayed, found.trials,
                           found.skipped > 0 ? fmt::format(" ({} cannot be)", found.skipped) : "",
                           found.findings == 0 ? "all the same, bit for bit; the store is sound"
                                               : fmt::format("{} findings", found.findings));
  if (options.hash) std::cout << fmt::format("results {}\n", found.hash);
  if (found.end != run::End::kFinished) return kStoppedEarly;
  return found.findings == 0 ? kOk : kCheckFailed;
}

}  // namespace

void add_verify(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = app.add_subcommand("verify", "Replay a fraction of a store's trials and check its integrity");
  command->add_option("DB", options->request.file, "Store")->required();
  command->add_option("--fraction", options->request.fraction, "Fraction of the trials to replay (0.1)")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--seed", options->request.seed, "Chooses other trials");
  command->add_option("--threads", options->request.threads, "Threads (all cores)")->check(CLI::Range(1, 4096));
  command->add_flag("--hash", options->hash, "Print one hash over all results: equal hashes mean equal rows");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->footer(
      "Exit 1 where a trial differs or the store is damaged.\n"
      "Example: moma verify results/demo.db --fraction 0.05 --hash");
  command->callback([&action, options] { action = [options] { return verify(*options); }; });
}

}  // namespace moma::cli
