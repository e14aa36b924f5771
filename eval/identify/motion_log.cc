#include "eval/identify/motion_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controller/config/node.h"

namespace moma::identify {
namespace {

constexpr std::size_t kLeastRows = 100;

}  // namespace

double period_of(const MotionLog& log) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < log.rows(); ++k) steps.push_back(log.time[k] - log.time[k - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void check_times(const MotionLog& log) {
  const auto line = [&](std::size_t row) {
    return config::Mark{log.source, log.first_line + static_cast<int>(row), 0};
  };
  if (log.rows() < kLeastRows) {
    config::fail({log.source, 0, 0}, "",
                 fmt::format("the log has {} rows; at least {} are needed, better 20 s of varied motion", log.rows(),
                             kLeastRows));
  }
  for (std::size_t k = 1; k < log.rows(); ++k) {
    if (log.time[k] > log.time[k - 1]) continue;
    config::fail(line(k), "time_s",
                 fmt::format("{} s comes after {} s: times have to grow", log.time[k], log.time[k - 1]));
  }
  const double period = period_of(log);
  for (std::size_t k = 1; k < log.rows(); ++k) {
    const double step = log.time[k] - log.time[k - 1];
    if (std::abs(step - period) <= 0.5 * period) continue;
    config::fail(
        line(k), "time_s",
        fmt::format("{:.6g} s after the row before, where the control period is {:.6g} s (the median): one row "
                    "a period is needed, within half of it",
                    step, period));
  }
}

}  // namespace moma::identify
