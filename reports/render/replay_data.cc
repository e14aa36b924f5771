#include "reports/render/replay_data.h"

#include <fmt/format.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <new>
#include <stdexcept>

#include "reports/render/packed.h"

namespace moma::reports {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are little-endian doubles");

constexpr std::uint64_t kLargestTable = std::uint64_t{512} << 20;  // bytes

std::vector<std::size_t> kept_rows(std::span<const double> t, double hz) {
  std::vector<std::size_t> rows;
  double next = -1e300;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < next && i + 1 < t.size()) continue;
    rows.push_back(i);
    // Half a microsecond of slack: times are sums of control periods.
    next = (std::floor(t[i] * hz + 1e-6) + 1.0) / hz - 5e-7;
  }
  return rows;
}

/// Quantizes to whole steps, clamped to 16 bits.
std::int16_t rounded(double value, double step) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value / step, -32768.0, 32767.0)));
}

/// Rounds to 16 significant bits: the last byte of each float becomes zero and compresses away.
double coarse(double value) {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(static_cast<float>(value)) + 0x80u) & ~0xffu);
}

/// Columns of the look-ahead: its activity, its reason, its path and its choice.
bool of_a_plan(std::string_view name) {
  return name.starts_with("plan_") || name == "detour" || name == "detour_x" || name == "detour_y";
}

Json packed_rows(const DistanceRows& all, std::span<const double> t, const std::vector<std::size_t>& kept) {
  constexpr double kMillimetre = 1e-3;
  constexpr int kActive = 8;
  std::vector<const DistanceRows::Row*> rows;
  Json counts = Json::array();
  for (const std::size_t sample : kept) {
    // Times of steps and of samples are the same products.
    const auto of_sample =
        std::equal_range(all.rows.begin(), all.rows.end(), DistanceRows::Row{.t = t[sample]},
                         [](const DistanceRows::Row& a, const DistanceRows::Row& b) { return a.t < b.t - 1e-6; });
    counts.push_back(of_sample.second - of_sample.first);
    for (auto row = of_sample.first; row != of_sample.second; ++row) rows.push_back(&*row);
  }
  std::vector<std::int16_t> values;
  const auto column = [&](const auto& value) {
    for (const DistanceRows::Row* row : rows) values.push_back(static_cast<std::int16_t>(value(*row)));
  };
  column([](const auto& row) { return static_cast<int>(row.kind) + (row.active ? kActive : 0); });
  column([](const auto& row) { return row.first; });
  column([](const auto& row) { return row.second; });
  column([](const auto& row) { return rounded(row.d, 0.1 * kMillimetre); });
  for (const auto point : {&DistanceRows::Row::p_first_W, &DistanceRows::Row::p_second_W})
    for (std::size_t k = 0; k < 3; ++k) column([&](const auto& row) { return rounded((row.*point)[k], kMillimetre); });
  return {{"names", all.names}, {"n", std::move(counts)}, {"data", packed(planes(values))}};
}

Json packed_map(const MapMotion& map) {
  std::vector<std::int16_t> values;
  const auto column = [&](const auto& value) {
    for (const MapMotion::Box& box : map.boxes) values.push_back(rounded(value(box), 1.0));
  };
  column([](const auto& box) { return box.from; });
  column([](const auto& box) { return box.to; });
  column([](const auto& box) { return box.seen ? 1 : 0; });
  for (std::size_t k = 0; k < 3; ++k) column([&](const auto& box) { return box.low[k]; });
  for (std::size_t k = 0; k < 3; ++k) column([&](const auto& box) { return box.high[k] - box.low[k]; });
  std::vector<float> looks;
  const auto keep = [&](const auto& value) {
    for (const MapMotion::Look& look : map.looks) looks.push_back(static_cast<float>(value(look)));
  };
  keep([](const auto& look) { return look.sensor; });
  keep([](const auto& look) { return look.t; });
  keep([](const auto& look) { return coarse(look.pan); });
  keep([](const auto& look) { return coarse(look.tilt); });
  return {{"cell", map.cell},
          {"hz", map.hz},
          {"data", packed(planes(values))},
          {"looks", {{"n", map.looks.size()}, {"data", packed(planes(looks))}}}};
}

std::vector<double> unpack(const StoredSamples& samples) {
  if (samples.layout != 1) throw std::runtime_error("samples: unknown layout");
  if (samples.n < 0 || samples.columns.empty()) throw std::runtime_error("samples: empty");
  if (static_cast<std::uint64_t>(samples.n) > kLargestTable / sizeof(double) / samples.columns.size())
    throw std::runtime_error(fmt::format("samples: {} of {} columns are more than the {} MiB that a trial may have",
                                         samples.n, samples.columns.size(), kLargestTable >> 20));
  const std::size_t wanted = static_cast<std::size_t>(samples.n) * samples.columns.size() * sizeof(double);
  const unsigned long long said = ZSTD_getFrameContentSize(samples.data.data(), samples.data.size());
  if (said != wanted) throw std::runtime_error("samples: size differs from its columns");
  std::vector<double> values(wanted / sizeof(double));
  const std::size_t got = ZSTD_decompress(values.data(), wanted, samples.data.data(), samples.data.size());
  if (ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(got) || got != wanted) throw std::runtime_error("samples: damaged");
  return values;
}

}  // namespace

Samples::Samples(const StoredSamples& stored)
    : n_(static_cast<std::size_t>(stored.n)), columns_(stored.columns), values_(unpack(stored)) {}

std::optional<std::span<const double>> Samples::find(std::string_view column) const {
  const auto place = std::ranges::find(columns_, column);
  if (place == columns_.end()) return {};
  return std::span(values_).subspan(n_ * static_cast<std::size_t>(place - columns_.begin()), n_);
}

std::span<const double> Samples::at(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  throw std::runtime_error("samples: there is no column " + std::string(column));
}

Json replay_data(const StoredSamples& stored, double hz, const DistanceRows* near, const MapMotion* map) {
  const Samples samples(stored);
  const std::vector<std::size_t> rows = kept_rows(samples.at("t"), hz);
  std::vector<std::string> names;
  std::vector<float> kept;
  const auto keep = [&](const std::string& name, const auto& value) {
    names.push_back(name);
    for (const std::size_t row : rows) kept.push_back(static_cast<float>(value(row)));
  };
  const auto keep_column = [&](
                               const std::string& name, double (*as)(double) = [](double value) { return value; }) {
    const std::span<const double> from = samples.at(name);
    keep(name, [&](std::size_t row) { return as(from[row]); });
  };
  const auto keep_norm = [&](const std::string& name, const std::string& stem, int first, int count) {
    std::vector<std::span<const double>> parts;
    for (int i = first; i < first + count; ++i) parts.push_back(samples.at(fmt::format("{}{}", stem, i)));
    keep(name, [&](std::size_t row) {
      double sum = 0.0;
      for (const std::span<const double> part : parts) sum += part[row] * part[row];
      return std::sqrt(sum);
    });
  };

  for (const char* name : {"t", "base_x", "base_y", "base_phi"}) keep_column(name);
  for (const char* stem : {"q", "command"})
    for (int i = 0; samples.find(fmt::format("{}{}", stem, i)); ++i) keep_column(fmt::format("{}{}", stem, i));
  keep_norm("error_rotation", "error", 0, 3);
  keep_norm("error_position", "error", 3, 3);
  keep_norm("slack", "slack", 0, 6);
  for (const char* name : {"manipulability", "least_distance", "status", "fallback", "active_rows"}) keep_column(name);
  // The rest, for a look at one of them.
  for (const std::string& name : stored.columns)
    if (std::ranges::find(names, name) == names.end() && !of_a_plan(name)) keep_column(name, &coarse);
  // A detour's target, and of a controller that looks ahead its activity and reason, its path and its choice.
  const auto ever = [&](std::string_view name) {
    const auto found = samples.find(name);
    return found && std::ranges::any_of(*found, [](double value) { return value != 0.0; });
  };
  const bool plans = ever("plan_mode") || ever("plan_reason") || ever("plan_attempts");
  if (plans || ever("detour")) {
    for (const std::string& name : stored.columns)
      if (of_a_plan(name) && (plans || !name.starts_with("plan_"))) keep_column(name);
  }

  Json out = {{"hz", hz}, {"n", rows.size()}, {"columns", names}, {"data", packed(planes(kept))}};
  if (near != nullptr) out["rows"] = packed_rows(*near, samples.at("t"), rows);
  if (map != nullptr && map->cell > 0.0) out["map"] = packed_map(*map);
  return out;
}

}  // namespace moma::reports
