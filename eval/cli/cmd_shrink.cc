#include <fmt/format.h>

#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/named_point.h"
#include "eval/run/shrink.h"
#include "files/output_file.h"
#include "world/world_json.h"

namespace moma::cli {
namespace {

struct ShrinkOptions {
  run::ShrinkRequest request;
  std::string out;
  files::Replace replace = files::Replace::kOwn;
  bool quiet = false;
};

int shrink(const ShrinkOptions& options) {
  const OutputFile file(options.out, {"file of worlds", ""}, options.replace);
  run::ShrinkRequest request = options.request;
  request.trial = run::named_trial(request.file, request.trial);
  const Computation computation(request, options.quiet);
  const run::Shrunk shrunk = run::shrink(request, computation.listener());
  const std::string world = to_json(shrunk.world).dump() + "\n";
  file.write(world);
  if (!file.wanted()) std::cout << world << std::flush;
  std::ostream& said = file.wanted() ? std::cout : std::cerr;
  said << terminal_safe(shrunk.sentence) << '\n';
  if (!options.quiet) {
    said << fmt::format(
        "{} trials; to run it, in the suite: --trials 1 --set 'worlds={{frozen: {}}}' --set 'disturbances={}'\n",
        shrunk.trials, options.out.empty() ? "FILE" : terminal_safe(options.out),
        shrunk.disturbances.empty() ? "none" : terminal_safe(shrunk.disturbances.dump()));
  }
  return shrunk.end == run::End::kFinished ? kOk : kStoppedEarly;
}

}  // namespace

void add_shrink(Commands& commands) {
  auto [command, options] = commands.add<ShrinkOptions>(
      "shrink", "Find the smallest world in which a stored trial still fails as it did", &shrink);
  add_store(command, options.request.file);
  add_trial(command, options.request.trial);
  command.add_option("-o,--output", options.out, "Write the world there, for `worlds: {frozen: FILE}`");
  command
      .add_option("--noises", options.request.noises,
                  "Number of draws of the disturbances for each candidate world (8)")
      ->check(CLI::Range(1, 1000));
  add_force(command, options.replace);
  add_threads(command, options.request.threads);
  add_allow_plugins(command, options.request.plugins);
  command.add_flag("-q,--quiet", options.quiet, "The sentence alone");
  command.footer(
      "Objects are taken away, disturbances switched off, motions stopped, the start is later, the goal nearer, "
      "numbers\n"
      "are rounded: what still fails by the same outcome, with the same object touched, is kept.\n"
      "Example: moma shrink results/demo.db 3f9a12 -o small.jsonl");
}

}  // namespace moma::cli
