#include "eval/cli/rare_options.h"

#include <fmt/format.h>

#include <stdexcept>

#include "eval/cli/command.h"

namespace moma::cli {

void add_rare_event(CLI::App& command, std::string& event) {
  command.add_option("--event", event,
                     "collision, timeout, stuck, joint_limit, infeasible, METRIC<VALUE or METRIC>VALUE (collision)");
}

run::RareEvent rare_event(const std::string& text, const std::string& command) {
  try {
    return run::RareEvent::read(text);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: --event: {}", command, error.what()));
  }
}

void add_splitting(CLI::App& command, risk::SplittingOptions& splitting) {
  command
      .add_option("--particles", splitting.particles, fmt::format("Worlds of a replicate ({})", splitting.particles))
      ->check(CLI::Range(10, 1000000));
  command
      .add_option("--replicates", splitting.replicates,
                  fmt::format("Independent ones, whose spread gives the interval ({})", splitting.replicates))
      ->check(CLI::Range(2, 10000));
  command.add_option("--moves", splitting.moves, fmt::format("Moves of each copy ({})", splitting.moves))
      ->check(CLI::Range(1, 1000));
  command
      .add_option("--levels", splitting.levels,
                  fmt::format("Most levels, each of which halves the probability ({})", splitting.levels))
      ->check(CLI::Range(1, 1000));
  command.add_option("--split-seed", splitting.seed, "Seed of choices and moves (1)");
}

void add_moved_trials_store(CLI::App& command, std::filesystem::path& file) {
  command.add_option("-o,--output", file,
                     "Store to keep trials in, made if missing: the same command goes on after a stop");
}

}  // namespace moma::cli
