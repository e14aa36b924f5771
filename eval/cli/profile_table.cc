#include "eval/cli/profile_table.h"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "eval/cli/table.h"

namespace moma::cli {

void print_profile(std::ostream& out, const Profile& profile) {
  if (profile.trials == 0) {
    out << "\nprofile: no trial was computed\n";
    return;
  }
  const auto whole = static_cast<double>(profile.nanoseconds());
  const auto trials = static_cast<double>(profile.trials);
  store::QueryResult table{{"part", "share %", "us a control step", "ms a trial", "times a trial"}, {}};
  const auto decimals = [](double value, double unit) { return std::round(value / unit) * unit; };
  const auto add = [&](std::string name, double nanoseconds, const store::Cell& times) {
    store::Cell step;
    if (profile.steps > 0) step = decimals(1e-3 * nanoseconds / static_cast<double>(profile.steps), 0.01);
    table.rows.push_back({std::move(name), decimals(100.0 * nanoseconds / whole, 0.01), step,
                          decimals(1e-6 * nanoseconds / trials, 0.001), times});
  };
  for (std::size_t i = 0; i < Profile::kParts; ++i) {
    const Profile::Share& share = profile.parts[i];
    if (share.entries == 0) continue;
    add(std::string(to_string(static_cast<TrialPart>(i))), static_cast<double>(share.nanoseconds),
        decimals(static_cast<double>(share.entries) / trials, 0.1));
  }
  add("whole", whole, store::Cell{});
  out << '\n';
  write(out, table, Format::kTable);
  out << fmt::format("{} trials, {} control steps, {:.2f} s of threads\n", profile.trials, profile.steps, 1e-9 * whole);
}

}  // namespace moma::cli
