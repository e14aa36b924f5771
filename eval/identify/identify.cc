#include "eval/identify/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/config/node.h"
#include "controller/describe/enumeration.h"
#include "eval/identify/response.h"
#include "eval/stats/intervals.h"

namespace moma::identify {
namespace {

constexpr double kLongest = 2.0;    // longest round trip considered [s]
constexpr double kExplained = 0.7;  // largest ratio of the best misfit to the worst
constexpr int kNear = 3;            // periods around the best of the coarse search that the fine search covers
constexpr double kStill = 1e-6;     // changes of a command below this count as none [rad/s, m/s]
// Least reduction of the squares by a ramp, in units of the remaining mean square per row.
constexpr double kRampShown = 10.0;
constexpr std::size_t kSaturated = 10;  // least number of rows that a detected ramp limits

struct Fitted {
  Group group;
  bool ramp = false;
  bool turning = false;
  Response response;
  double variance = 1.0;  // of the measured velocity, for sums over axes of different units
};

double change_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

double largest_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return std::max(-*low, *high);
}

double variance_of(const Group& group, std::size_t from) {
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (const Axis* axis : group)
    for (std::size_t k = from; k < axis->velocity.size(); ++k, n += 1.0) {
      sum += axis->velocity[k];
      squares += axis->velocity[k] * axis->velocity[k];
    }
  return squares / n - sum / n * (sum / n);
}

/// The round trip of groups with a common latency, or the reason why the log does not show it.
struct Trip {
  int periods = 0;
  std::string why_not;
};

Trip find_trip(std::vector<Fitted>& parts, std::size_t rows, double period) {
  std::vector<Fitted*> moved;
  for (Fitted& part : parts) {
    bool changes = false;
    for (const Axis* axis : part.group) changes = changes || change_of(axis->command) > kStill;
    if (changes) moved.push_back(&part);
  }
  if (moved.empty()) return {0, "its commands never change"};
  const int longest = static_cast<int>(std::min(kLongest / period, 0.25 * static_cast<double>(rows)));
  const std::size_t from = static_cast<std::size_t>(longest) + 1;
  for (Fitted* part : moved) part->variance = std::max(variance_of(part->group, from), 1e-18);
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  Trip trip;
  const auto misfit = [&](int n, Ramp ramp) {
    double sum = 0.0;
    for (const Fitted* part : moved)
      sum += fit_response(part->group, n, from, part->ramp ? ramp : Ramp::kNone, period).squared / part->variance;
    return sum;
  };
  const auto look = [&](int first, int last, Ramp ramp) {
    for (int n = std::max(0, first); n <= std::min(longest, last); ++n) {
      const double sum = misfit(n, ramp);
      most = std::max(most, sum);
      if (!(sum < least)) continue;
      least = sum;
      trip.periods = n;
    }
  };
  look(0, longest, Ramp::kCoarse);
  look(trip.periods - kNear, trip.periods + kNear, Ramp::kFine);
  if (!(least < kExplained * most)) return {0, "its motion does not follow from its commands, or drowns in noise"};
  for (Fitted& part : parts)
    part.response = fit_response(part.group, trip.periods, from, part.ramp ? Ramp::kFine : Ramp::kNone, period);
  return trip;
}

// Returns measured minus modelled values of an axis, row by row, without the rows before the first command.
std::vector<double> off_model(const Fitted& part, std::size_t axis, int trip, double period) {
  const double a = part.response.acceleration / std::abs(part.response.gain);
  const auto r = ramped(part.group, trip, a, period);
  const std::vector<double>& v = part.group[axis]->velocity;
  std::vector<double> out;
  for (std::size_t k = static_cast<std::size_t>(trip) + 1; k < v.size(); ++k)
    out.push_back(v[k] - part.response.gain * r[axis][k - 1 - static_cast<std::size_t>(trip)]);
  return out;
}

// Returns the fastest change of a group's commands from row to row [1/s^2 of their unit].
double fastest_change(const Group& group, double period) {
  double fastest = 0.0;
  for (std::size_t k = 1; k < group.front()->command.size(); ++k) {
    double squared = 0.0;
    for (const Axis* axis : group) squared += std::pow(axis->command[k] - axis->command[k - 1], 2);
    fastest = std::max(fastest, std::sqrt(squared));
  }
  return fastest / period;
}

Drive drive_of(const Fitted& part, int trip, double period) {
  Drive out;
  out.gain = part.response.gain;
  std::vector<double> noises;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < part.group.size(); ++i) {
    const std::vector<double> off = off_model(part, i, trip, period);
    rows += off.size();
    noises.push_back(noise_of(off));
  }
  double squares = 0.0;
  for (const double noise : noises) squares += noise * noise;
  out.velocity_noise = std::sqrt(squares / static_cast<double>(noises.size()));
  if (!part.ramp) return out;
  const auto longest = static_cast<std::size_t>(trip) + 1;
  const Response without = fit_response(part.group, trip, longest, Ramp::kNone, period);
  const Response with = fit_response(part.group, trip, longest, Ramp::kFine, period);
  const double left = with.squared / static_cast<double>(rows);
  if (with.saturated >= kSaturated && without.squared - with.squared > kRampShown * left)
    out.acceleration = with.acceleration;
  else
    out.least_acceleration = std::abs(out.gain) * fastest_change(part.group, period);
  return out;
}

struct FoundLatency {
  Latency latency;
  int periods = 0;  // of the round trip
};

/// Estimates sensing latency and jitter from the stamps.
void read_stamps(const std::vector<double>& time, const std::vector<double>& stamp, Latency& latency) {
  latency.drive = latency.round_trip;
  if (stamp.empty()) return;
  std::vector<double> ages;
  for (std::size_t k = 0; k < time.size(); ++k) ages.push_back(time[k] - stamp[k]);
  // Rows before the first measurement has arrived are older than their stamps.
  const auto from = static_cast<std::ptrdiff_t>(std::min(ages.size() / 10, std::size_t{200}));
  ages.erase(ages.begin(), ages.begin() + from);
  latency.has_stamps = true;
  latency.sensing = std::max(0.0, stats::median(ages));
  latency.jitter = *std::ranges::max_element(ages) - *std::ranges::min_element(ages);
  latency.drive = std::max(0.0, latency.round_trip - latency.sensing);
}

// Estimates the noise of the pose: each step's motion minus the model's, whose mean over a period is taken along the
// way.
void find_pose_noise(const MotionLog& log, const std::vector<Fitted>& parts, int trip, FoundBase& out) {
  if (log.base_x.empty()) return;
  const double T = period_of(log);
  const bool pair = log.base.size() == 3;
  std::vector<std::vector<double>> v(3, std::vector<double>(log.rows(), 0.0));  // vx, vy, omega of the model
  for (const Fitted& part : parts) {
    const auto r = ramped(part.group, trip, part.response.acceleration / std::abs(part.response.gain), T);
    for (std::size_t i = 0; i < part.group.size(); ++i) {
      std::vector<double>& to = v[part.turning ? 2 : pair ? i : 0];
      for (std::size_t k = 0; k < log.rows(); ++k) to[k] = part.response.gain * r[i][k];
    }
  }
  std::vector<double> across, turned;
  for (std::size_t k = static_cast<std::size_t>(trip) + 2; k < log.rows(); ++k) {
    const std::size_t now = k - 1 - static_cast<std::size_t>(trip);
    const auto mean = [&](int i) {
      const auto& u = v[static_cast<std::size_t>(i)];
      return 0.5 * (u[now] + u[now - 1]);
    };
    const double turn = std::remainder(log.base_heading[k] - log.base_heading[k - 1], 2.0 * std::numbers::pi);
    turned.push_back(turn - T * mean(2));
    const double phi = log.base_heading[k - 1] + 0.5 * turn, c = std::cos(phi), s = std::sin(phi);
    across.push_back(log.base_x[k] - log.base_x[k - 1] - T * (c * mean(0) - s * mean(1)));
    across.push_back(log.base_y[k] - log.base_y[k - 1] - T * (s * mean(0) + c * mean(1)));
  }
  out.position_noise = robust_deviation(across) / std::sqrt(2.0);
  out.heading_noise = robust_deviation(turned) / std::sqrt(2.0);
}

constexpr double kOwn = 0.5;  // least share of a column's squares that another has to explain to be compared with it

double times_of(double factor) { return std::max(std::abs(factor), 1.0 / std::abs(factor)); }

// Throws if a factor between two columns that should agree is negative, or far from 1. `what` names it.
void check_factor(const MotionLog& log, const Axis& axis, const std::string& what, double factor) {
  constexpr double kRefused = 3.0, kDegrees = 180.0 / std::numbers::pi;
  const double times = times_of(factor);
  if (factor < 0.0)
    throw config::ConfigError(
        fmt::format("{}: {}: {}: one of the two has the wrong sign", log.source, axis.name, what));
  if (times <= kRefused) return;
  const bool in_degrees = !axis.prismatic && times > 0.8 * kDegrees && times < 1.25 * kDegrees;
  throw config::ConfigError(fmt::format("{}: {}: {}: {}", log.source, axis.name, what,
                                        in_degrees ? "one of the two is in degrees" : "are their units the same?"));
}

// Compares changes of an axis's position with its velocity. Noise and turns of an endless joint hide what they say.
void check_position(const MotionLog& log, const Axis& axis, double period) {
  double product = 0.0, squares = 0.0, moved = 0.0;
  for (std::size_t k = 1; k < axis.position.size(); ++k) {
    const double way = 0.5 * period * (axis.velocity[k] + axis.velocity[k - 1]);
    const double change = axis.position[k] - axis.position[k - 1];
    product += way * change;
    squares += way * way;
    moved += change * change;
  }
  if (!(product * product > kOwn * squares * moved)) return;
  const double factor = product / squares;
  check_factor(log, axis, fmt::format("positions change {:.3g} times as fast as the measured velocities", factor),
               factor);
}

// Detects motion that no drive produces: opposite to the command, or many times faster or slower. Columns without
// enough motion pass.
void check_gains(const MotionLog& log, const std::vector<Fitted>& parts, int trip, Found& found) {
  constexpr double kDoubted = 1.3;
  constexpr double kFastestCommand = 20.0;  // a faster command is in other units [rad/s, m/s]
  const std::size_t from = static_cast<std::size_t>(trip) + 1;
  for (const Fitted& part : parts) {
    for (const Axis* axis : part.group) {
      const Response alone = fit_response({axis}, trip, from, part.ramp ? Ramp::kCoarse : Ramp::kNone, found.period);
      double squares = 0.0;
      for (std::size_t k = from; k < axis->velocity.size(); ++k) squares += axis->velocity[k] * axis->velocity[k];
      if (!(change_of(axis->command) > kStill) || !(alone.squared < kOwn * squares)) continue;
      const std::string what = fmt::format("measured velocities are {:.3g} times the commands", alone.gain);
      check_factor(log, *axis, what, alone.gain);
      check_position(log, *axis, found.period);
      if (const double fastest = largest_of(axis->command); fastest > kFastestCommand)
        found.notes.push_back(fmt::format(
            "{}: commands of up to {:.3g} are faster than drives are: degrees or millimetres?", axis->name, fastest));
      if (times_of(alone.gain) > kDoubted)
        found.notes.push_back(axis->name + ": " + what + ", which is far for a drive: are both in the same unit?");
    }
  }
}

/// Returns the latency that all parts share. Empty if the log does not show it; a note then names the reason.
std::optional<FoundLatency> find_latency(const MotionLog& log, std::vector<Fitted>& parts,
                                         const std::vector<double>& stamps, std::string_view of, Found& found) {
  const Trip trip = find_trip(parts, log.rows(), found.period);
  if (!trip.why_not.empty()) {
    found.notes.push_back(fmt::format("nothing can be said of {}: {}", of, trip.why_not));
    return {};
  }
  check_gains(log, parts, trip.periods, found);
  FoundLatency out{.latency = {}, .periods = trip.periods};
  out.latency.round_trip = trip.periods * found.period;
  read_stamps(log.time, stamps, out.latency);
  return out;
}

// Compares changes of the base's heading with its rate of turn, and its way along the heading with its speed.
void check_pose(const MotionLog& log, double period) {
  if (log.base_heading.empty()) return;
  Axis heading = log.base.back(), along = log.base.front();
  heading.name = "base.heading";
  heading.position = {log.base_heading.front()};
  along.name = "base.x_m, base.y_m";
  along.prismatic = true;
  along.position = {0.0};
  for (std::size_t k = 1; k < log.rows(); ++k) {
    const double turn = std::remainder(log.base_heading[k] - log.base_heading[k - 1], 2.0 * std::numbers::pi);
    heading.position.push_back(heading.position.back() + turn);
    const double phi = log.base_heading[k - 1] + 0.5 * turn;
    const double dx = log.base_x[k] - log.base_x[k - 1], dy = log.base_y[k] - log.base_y[k - 1];
    along.position.push_back(along.position.back() + std::cos(phi) * dx + std::sin(phi) * dy);
  }
  check_position(log, heading, period);
  check_position(log, along, period);
}

void identify_base(const MotionLog& log, Found& found) {
  if (log.base.empty()) return;
  std::vector<Fitted> parts(2);
  for (const Axis& axis : log.base) parts[axis.name == "base.omega" ? 1 : 0].group.push_back(&axis);
  parts[0].ramp = parts[1].ramp = true;
  parts[1].turning = true;
  const auto trip = find_latency(log, parts, log.base_stamp, "the base", found);
  if (!trip) return;
  check_pose(log, found.period);
  FoundBase& out = found.base.emplace();
  out.latency = trip->latency;
  out.linear = drive_of(parts[0], trip->periods, found.period);
  out.turn = drive_of(parts[1], trip->periods, found.period);
  find_pose_noise(log, parts, trip->periods, out);
  const auto note = [&](const Drive& drive, const char* of, const char* unit) {
    if (drive.acceleration) return;
    found.notes.push_back(
        fmt::format("the {} shows no ramp: its commands change by {:.3g} {} at most, and the base follows them. Drive "
                    "with steps of "
                    "the command to find it",
                    of, drive.least_acceleration, unit));
  };
  note(out.linear, "base's linear velocity", "m/s^2");
  note(out.turn, "base's turning", "rad/s^2");
}

void identify_joints(const MotionLog& log, Found& found) {
  if (log.joints.empty()) return;
  std::vector<Fitted> parts(log.joints.size());
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].group = {&log.joints[i]};
  const auto trip = find_latency(log, parts, log.joint_stamp, "the joints", found);
  if (!trip) return;
  FoundJoints& out = found.joints.emplace();
  out.latency = trip->latency;
  double squares = 0.0, gains = 0.0, moved = 0.0;
  std::vector<double> off;
  for (const Fitted& part : parts) {
    const Drive drive = drive_of(part, trip->periods, found.period);
    squares += drive.velocity_noise * drive.velocity_noise;
    const Axis& axis = *part.group.front();
    if (change_of(axis.command) > kStill) {
      gains += (drive.gain - 1.0) * (drive.gain - 1.0);
      moved += 1.0;
    } else {
      found.notes.push_back(fmt::format("joint {} was not moved", axis.name));
    }
    if (axis.position.empty()) continue;
    for (std::size_t k = static_cast<std::size_t>(trip->periods) + 1; k < log.rows(); ++k) {
      const double u = axis.command[k - 1 - static_cast<std::size_t>(trip->periods)];
      off.push_back(axis.position[k] - axis.position[k - 1] - found.period * drive.gain * u);
    }
  }
  out.velocity_noise = std::sqrt(squares / static_cast<double>(parts.size()));
  out.gain_deviation = std::sqrt(gains / std::max(1.0, moved));
  if (!off.empty()) out.position_noise = robust_deviation(off) / std::sqrt(2.0);
}

void identify_objects(const MotionLog& log, Found& found) {
  if (log.objects.empty()) return;
  FoundObjects& out = found.objects.emplace();
  double squares = 0.0;
  std::vector<double> ages;
  for (const LoggedObject& object : log.objects) {
    for (const auto* values : {&object.x, &object.y, &object.z}) {
      const double noise = noise_of_even_motion(*values);
      squares += noise * noise;
    }
    for (std::size_t k = object.stamp.size() / 10; k < object.stamp.size(); ++k)
      ages.push_back(log.time[k] - object.stamp[k]);
  }
  out.position_noise = std::sqrt(squares / (3.0 * static_cast<double>(log.objects.size())));
  if (!ages.empty())
    out.sensing = std::max(0.0, stats::median(ages));
  else
    found.notes.push_back("the age of object measurements cannot be found without object.NAME.stamp_s");
}

}  // namespace

Found identify(const MotionLog& log) {
  check_times(log);
  Found found;
  found.period = period_of(log);
  found.rows = log.rows();
  identify_base(log, found);
  identify_joints(log, found);
  identify_objects(log, found);
  if (!found.base && !found.joints) {
    config::fail({log.source, 0, 0}, "", "not identifiable: " + joined(found.notes, {}, "; "));
  }
  return found;
}

}  // namespace moma::identify
