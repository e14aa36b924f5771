#include "eval/batch/wire.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include "world/scenario/worlds.h"
#include "world/world_json.h"

namespace moma {
namespace {

class Writer {
 public:
  template <typename Number>
  void number(const Number& value) {
    static_assert(std::is_arithmetic_v<Number> || std::is_enum_v<Number>);
    raw(&value, sizeof value);
  }
  void text(const std::string& value) {
    number<std::uint64_t>(value.size());
    raw(value.data(), value.size());
  }
  void numbers(VectorX& value) {
    number<std::uint64_t>(static_cast<std::uint64_t>(value.size()));
    raw(value.data(), static_cast<std::size_t>(value.size()) * sizeof(double));
  }
  template <int n>
  void numbers(Eigen::Matrix<double, n, 1>& value) {
    raw(value.data(), sizeof(double) * n);
  }
  Bytes bytes;

 private:
  void raw(const void* data, std::size_t size) {
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  }
};

class Reader {
 public:
  explicit Reader(std::span<const unsigned char> bytes) : left_(bytes) {}
  template <typename Number>
  void number(Number& value) {
    raw(&value, sizeof value);
  }
  std::size_t size(std::size_t element) {
    std::uint64_t n = 0;
    number(n);
    if (n > left_.size() / element) throw std::runtime_error("a result from another process is damaged");
    return static_cast<std::size_t>(n);
  }
  void text(std::string& value) {
    value.resize(size(1));
    raw(value.data(), value.size());
  }
  void numbers(VectorX& value) {
    value.resize(static_cast<Eigen::Index>(size(sizeof(double))));
    raw(value.data(), static_cast<std::size_t>(value.size()) * sizeof(double));
  }
  template <int n>
  void numbers(Eigen::Matrix<double, n, 1>& value) {
    raw(value.data(), sizeof(double) * n);
  }
  bool done() const { return left_.empty(); }

 private:
  void raw(void* data, std::size_t size) {
    if (size > left_.size()) throw std::runtime_error("a result from another process is damaged");
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_ = left_.subspan(size);
  }
  std::span<const unsigned char> left_;
};

/// Every member, in one order for both directions.
template <typename Archive>
void visit(Archive& a, TrialRow& r) {
  a.number(r.outcome);
  for (std::string* text : {&r.reason, &r.link, &r.object}) a.text(*text);
  for (double* x : {&r.time_end_s,
                    &r.time_to_goal_s,
                    &r.position_error_m,
                    &r.orientation_error_rad,
                    &r.path_ee_m,
                    &r.path_base_m,
                    &r.manip_mean,
                    &r.manip_min,
                    &r.manip_final,
                    &r.manip_all_mean,
                    &r.manip_all_min,
                    &r.manip_all_final,
                    &r.clearance_min_m,
                    &r.limit_margin_min,
                    &r.collision_time_s,
                    &r.collision_depth_m,
                    &r.jerk_ee_rms,
                    &r.jerk_joint_rms,
                    &r.energy_j,
                    &r.command_change_mean,
                    &r.clearance_self_min_m,
                    &r.slack_mean,
                    &r.slack_max,
                    &r.active_rows_mean,
                    &r.slip_max_m_s,
                    &r.tracking_error_rms,
                    &r.detector_deepest_m})
    a.number(*x);
  for (int* n :
       {&r.collision_count, &r.qp_infeasible, &r.fallback_no_acceleration, &r.fallback_relaxed, &r.fallback_brake,
        &r.lcp_messages, &r.steps, &r.detector_checks, &r.detector_disagreements, &r.timing.deadline_misses})
    a.number(*n);
  TrialRow::Timing& t = r.timing;
  for (double* x : {&t.t_solve_median_us, &t.t_solve_p99_us, &t.t_solve_max_us, &t.t_step_median_us, &t.t_step_p99_us,
                    &t.t_step_max_us, &t.t_trial_us})
    a.number(*x);
}

template <typename Archive>
void visit(Archive& a, Sample& s) {
  a.number(s.t);
  a.numbers(s.base);
  for (VectorX* v : {&s.q, &s.qdot, &s.command}) a.numbers(*v);
  a.numbers(s.error);
  a.numbers(s.slack);
  a.number(s.manipulability);
  a.number(s.least_distance);
  a.number(s.status);
  a.number(s.fallback);
  a.number(s.active_rows);
  EscapeState& e = s.escape;
  for (double* x : {&e.best, &e.idle, &e.remaining}) a.number(*x);
  for (int* n : {&e.stagnations, &e.side, &e.circulation}) a.number(*n);
  a.number(e.detour);
  a.number(e.around);
  a.numbers(e.target_W);
}

}  // namespace

Bytes encode_result(std::uint64_t place, const BatchResult& result) {
  Writer a;
  a.number(place);
  a.text(result.world == nullptr ? std::string() : to_json(*result.world).dump());
  TrialRow row = result.output.row;
  visit(a, row);
  a.number<std::uint64_t>(result.metrics.size());
  for (const double value : result.metrics) a.number(value);
  a.number<std::uint64_t>(result.output.trace.size());
  for (Sample sample : result.output.trace) visit(a, sample);
  return std::move(a.bytes);
}

DecodedResult decode_result(std::span<const unsigned char> bytes) {
  DecodedResult decoded;
  Reader a(bytes);
  a.number(decoded.place);
  std::string world;
  a.text(world);
  BatchResult& result = decoded.result;
  if (!world.empty())
    result.world = std::make_shared<const World>(
        world_from_json(nlohmann::ordered_json::parse(world), "a world from another process"));
  visit(a, result.output.row);
  result.metrics.resize(a.size(sizeof(double)));
  for (double& value : result.metrics) a.number(value);
  result.output.trace.resize(a.size(sizeof(double)));
  for (Sample& sample : result.output.trace) visit(a, sample);
  if (!a.done()) throw std::runtime_error("a result from another process is damaged");
  return decoded;
}

}  // namespace moma
