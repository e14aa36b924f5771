#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/store/database.h"
#include "eval/store/merge.h"

namespace moma::cli {

void add_merge(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    std::filesystem::path out;
    std::vector<std::filesystem::path> in;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("merge", "Join stores of several machines into one");
  command->add_option("OUT", options->out, "Store to write: made if missing, else added to")->required();
  command->add_option("IN", options->in, "Stores to join")->required()->expected(1, 100000);
  command->footer(
      "Waits for runs on any of them, and takes in what their -wal files hold: with one IN it is the way to copy a\n"
      "store, where cp of the .db alone can lose trials. Searches of moma tune and tables of other programs come "
      "along.\n"
      "The same trial twice is kept once; two results for one trial from machines of one class are a\n"
      "contradiction: exit 1, and OUT stays as it was.\n"
      "Example: moma merge results/all.db results/shard-*.db");
  command->callback([&action, options] {
    action = [options] {
      const InterruptGuard interrupt;
      const store::MergeOptions merging{
          &InterruptGuard::flag(), [](const std::string& words) { std::cerr << terminal_safe(words) << std::endl; }};
      const store::MergeSummary summary = store::merge(options->out, options->in, merging);
      const std::string warning = store::file_system_warning(options->out);
      if (!warning.empty()) print_warnings({warning});
      print_warnings(summary.notes);
      std::cerr << fmt::format(
          "{}: {} trials added, {} were there already{}\n", options->out.string(), summary.added, summary.present,
          summary.searches > 0 ? fmt::format("; {} searches added or continued", summary.searches) : "");
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
