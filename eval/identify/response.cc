#include "eval/identify/response.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/stats/intervals.h"

namespace moma::identify {
namespace {

constexpr double kNormal = 1.4826;  // 1/Phi^-1(3/4)

}  // namespace

double robust_deviation(std::vector<double>& values) {
  for (double& value : values) value = std::abs(value);
  return values.empty() ? 0.0 : kNormal * stats::median(values);
}

double noise_of(const std::vector<double>& off) {
  if (off.size() < 3) return 0.0;
  std::vector<double> differences;
  for (std::size_t k = 1; k < off.size(); ++k) differences.push_back(off[k] - off[k - 1]);
  return robust_deviation(differences) / std::sqrt(2.0);
}

double noise_of_even_motion(const std::vector<double>& values) {
  if (values.size() < 4) return 0.0;
  std::vector<double> bends;
  for (std::size_t k = 2; k < values.size(); ++k) bends.push_back(values[k] - 2.0 * values[k - 1] + values[k - 2]);
  return robust_deviation(bends) / std::sqrt(6.0);
}

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kSlowest = 0.02, kFastest = 200.0;  // [m/s^2, rad/s^2]
constexpr int kCoarse = 20, kFine = 60;

// Fits the gain alone by least squares.
Response fit_gain(const Group& group, int n, std::size_t from, double acceleration, double period, bool* limited) {
  const auto r = ramped(group, n, acceleration, period, limited);
  double rr = 0.0, rv = 0.0, vv = 0.0;
  for (std::size_t i = 0; i < group.size(); ++i) {
    const std::vector<double>& v = group[i]->velocity;
    for (std::size_t k = from; k < v.size(); ++k) {
      const double model = r[i][k - 1 - static_cast<std::size_t>(n)];
      rr += model * model;
      rv += model * v[k];
      vv += v[k] * v[k];
    }
  }
  Response out;
  out.gain = rr > 0.0 ? rv / rr : 1.0;
  out.acceleration = std::abs(out.gain) * acceleration;
  out.squared = std::max(0.0, vv - 2.0 * out.gain * rv + out.gain * out.gain * rr);
  return out;
}

std::size_t count_saturated(const Group& group, int n, double acceleration, double period) {
  const auto r = ramped(group, n, acceleration, period);
  std::size_t count = 0;
  for (std::size_t k = 1; k < r.front().size(); ++k) {
    double squared = 0.0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const double off = group[i]->command[k] - r[i][k - 1];
      squared += off * off;
    }
    count += std::sqrt(squared) > acceleration * period * (1.0 + 1e-9) ? 1 : 0;
  }
  return count;
}

}  // namespace

std::vector<std::vector<double>> ramped(const Group& group, int n, double acceleration, double period, bool* limited) {
  std::vector<std::vector<double>> out(group.size());
  for (std::size_t i = 0; i < group.size(); ++i) out[i] = group[i]->command;
  if (std::isinf(acceleration)) return out;
  for (std::size_t i = 0; i < group.size(); ++i) out[i].front() = group[i]->velocity[static_cast<std::size_t>(n) + 1];
  const double most = acceleration * period;
  for (std::size_t k = 1; k < out.front().size(); ++k) {
    double squared = 0.0;
    for (const std::vector<double>& r : out) squared += (r[k] - r[k - 1]) * (r[k] - r[k - 1]);
    const double size = group.size() == 1 ? std::abs(out[0][k] - out[0][k - 1]) : std::sqrt(squared);
    const double part = size > most ? most / size : 1.0;
    if (limited != nullptr) *limited = *limited || size > most;
    for (std::vector<double>& r : out) r[k] = r[k - 1] + part * (r[k] - r[k - 1]);
  }
  return out;
}

Response fit_response(const Group& group, int n, std::size_t from, Ramp ramp, double period) {
  bool limited = true;
  const auto at = [&](double acceleration) { return fit_gain(group, n, from, acceleration, period, &limited); };
  Response best = at(kInfinite);
  if (ramp == Ramp::kNone) return best;
  const int grid = ramp == Ramp::kFine ? kFine : kCoarse;
  double best_log = kInfinite;
  const double low = std::log(kSlowest), step = (std::log(kFastest) - low) / (grid - 1);
  double least = best.squared;
  for (int i = 0; i < grid && limited; ++i) {  // beyond the first that limits no row all are the same
    limited = false;
    const Response here = at(std::exp(low + i * step));
    if (!(here.squared < least)) continue;
    least = here.squared;
    best = here;
    best_log = low + i * step;
  }
  if (std::isinf(best_log) || ramp == Ramp::kCoarse) return best;
  // Golden section: within the grid's resolution the misfit has one minimum between the neighbours.
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = best_log - step, b = best_log + step;
  double c = b - golden * (b - a), d = a + golden * (b - a);
  Response at_c = at(std::exp(c)), at_d = at(std::exp(d));
  for (int i = 0; i < 30; ++i) {
    if (at_c.squared < at_d.squared) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - golden * (b - a);
      at_c = at(std::exp(c));
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + golden * (b - a);
      at_d = at(std::exp(d));
    }
  }
  const Response& finer = at_c.squared < at_d.squared ? at_c : at_d;
  if (finer.squared < best.squared) best = finer;
  best.saturated = count_saturated(group, n, best.acceleration / std::abs(best.gain), period);
  return best;
}

}  // namespace moma::identify
