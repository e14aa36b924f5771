#include "eval/store/columns.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace moma::store {
namespace {

using Row = TrialRow;
using Timing = TrialRow::Timing;

constexpr std::array kTrialColumns = std::to_array<TrialColumn>({
    {"reason", &Row::reason},
    {"link", &Row::link},
    {"object", &Row::object},
    {"time_end_s", &Row::time_end_s},
    {"time_to_goal_s", &Row::time_to_goal_s},
    {"position_error_m", &Row::position_error_m},
    {"orientation_error_rad", &Row::orientation_error_rad},
    {"path_ee_m", &Row::path_ee_m},
    {"path_base_m", &Row::path_base_m},
    {"manip_mean", &Row::manip_mean},
    {"manip_min", &Row::manip_min},
    {"manip_final", &Row::manip_final},
    {"manip_all_mean", &Row::manip_all_mean},
    {"manip_all_min", &Row::manip_all_min},
    {"manip_all_final", &Row::manip_all_final},
    {"clearance_min_m", &Row::clearance_min_m},
    {"clearance_self_min_m", &Row::clearance_self_min_m},
    {"limit_margin_min", &Row::limit_margin_min},
    {"collision_count", &Row::collision_count},
    {"collision_time_s", &Row::collision_time_s},
    {"collision_depth_m", &Row::collision_depth_m},
    {"jerk_ee_rms", &Row::jerk_ee_rms},
    {"jerk_joint_rms", &Row::jerk_joint_rms},
    {"command_change_mean", &Row::command_change_mean},
    {"energy_j", &Row::energy_j},
    {"slack_mean", &Row::slack_mean},
    {"slack_max", &Row::slack_max},
    {"active_rows_mean", &Row::active_rows_mean},
    {"qp_infeasible", &Row::qp_infeasible},
    {"fallback_no_acceleration", &Row::fallback_no_acceleration},
    {"fallback_relaxed", &Row::fallback_relaxed},
    {"fallback_brake", &Row::fallback_brake},
    {"slip_max_m_s", &Row::slip_max_m_s},
    {"tracking_error_rms", &Row::tracking_error_rms},
    {"lcp_messages", &Row::lcp_messages},
    {"steps", &Row::steps},
    {"detector_checks", &Row::detector_checks},
    {"detector_disagreements", &Row::detector_disagreements},
    {"detector_deepest_m", &Row::detector_deepest_m},
});

constexpr std::array kTimingColumns = std::to_array<TimingColumn>({
    {"t_solve_median_us", &Timing::t_solve_median_us},
    {"t_solve_p99_us", &Timing::t_solve_p99_us},
    {"t_solve_max_us", &Timing::t_solve_max_us},
    {"t_step_median_us", &Timing::t_step_median_us},
    {"t_step_p99_us", &Timing::t_step_p99_us},
    {"t_step_max_us", &Timing::t_step_max_us},
    {"t_trial_us", &Timing::t_trial_us},
    {"deadline_misses", &Timing::deadline_misses},
});

bool same(double a, double b) noexcept {
  a = stored(a);
  b = stored(b);
  return a == b || (std::isnan(a) && std::isnan(b));
}
bool same(int a, int b) noexcept { return a == b; }
bool same(const std::string& a, const std::string& b) noexcept { return a == b; }

}  // namespace

std::span<const TrialColumn> trial_columns() noexcept { return kTrialColumns; }
std::span<const TimingColumn> timing_columns() noexcept { return kTimingColumns; }

Outcome outcome_from_string(const std::string& text) {
  for (const Outcome outcome :
       {Outcome::kSuccess, Outcome::kCollision, Outcome::kTimeout, Outcome::kStuck, Outcome::kJointLimit,
        Outcome::kTipped, Outcome::kInfeasible, Outcome::kDiverged, Outcome::kError}) {
    if (to_string(outcome) == text) return outcome;
  }
  throw std::invalid_argument("unknown outcome " + text);
}

double stored(double value) noexcept { return std::isfinite(value) ? value + 0.0 : kAbsent; }

std::vector<std::string> differences(const TrialRow& a, const TrialRow& b) {
  std::vector<std::string> found;
  if (a.outcome != b.outcome) {
    found.push_back(fmt::format("outcome: {} != {}", to_string(a.outcome), to_string(b.outcome)));
  }
  for (const TrialColumn& column : kTrialColumns) {
    std::visit(
        [&](auto member) {
          if (!same(a.*member, b.*member)) {
            found.push_back(fmt::format("{}: {} != {}", column.name, a.*member, b.*member));
          }
        },
        column.member);
  }
  return found;
}

}  // namespace moma::store
