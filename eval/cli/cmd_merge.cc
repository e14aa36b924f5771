#include <fmt/format.h>

#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/store/database.h"
#include "eval/store/merge.h"

namespace moma::cli {
namespace {

struct MergeStores {
  fs::path out;
  std::vector<fs::path> in;
};

int merge(const MergeStores& options) {
  const InterruptGuard interrupt;
  const store::MergeSummary summary = store::merge(
      options.out, options.in,
      {&InterruptGuard::flag(), [](const std::string& words) { std::cerr << terminal_safe(words) << std::endl; }});
  const std::string warning = store::file_system_warning(options.out);
  if (!warning.empty()) print_warnings({warning});
  print_warnings(summary.notes);
  std::cerr << fmt::format(
      "{}: {} trials added, {} were there already{}\n", options.out.string(), summary.added, summary.present,
      summary.searches > 0 ? fmt::format("; {} searches added or continued", summary.searches) : "");
  return kOk;
}

}  // namespace

void add_merge(Commands& commands) {
  auto [command, options] = commands.add<MergeStores>("merge", "Join stores of several machines into one", &merge);
  command.add_option("OUT", options.out, "Store to write: made if missing, else added to")->required();
  command.add_option("IN", options.in, "Stores to join")->required()->expected(1, 100000);
  command.footer(
      "Waits for runs on any of them, and takes in what their -wal files hold: with one IN it is the way to copy a\n"
      "store, where cp of the .db alone can lose trials. Searches of moma tune and tables of other programs come "
      "along.\n"
      "The same trial twice is kept once; two results for one trial from machines of one class are a\n"
      "contradiction: exit 1, and OUT stays as it was.\n"
      "Example: moma merge results/all.db results/shard-*.db");
}

}  // namespace moma::cli
