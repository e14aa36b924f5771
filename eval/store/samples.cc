#include "eval/store/samples.h"

#include <fmt/format.h>
#include <zstd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace moma::store {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are stored little-endian");

constexpr int kCompressionLevel = 3;
// No trace comes near this; a damaged frame must not make us ask for all memory.
constexpr std::uint64_t kLargestFrame = std::uint64_t{1} << 32;

struct Sizes {
  Eigen::Index q = 0;
  Eigen::Index v = 0;
  bool operator==(const Sizes&) const = default;
};

Sizes sizes_of(const Sample& sample) {
  if (sample.command.size() != sample.qdot.size()) {
    throw std::invalid_argument("a sample's qdot and command differ in size");
  }
  return {sample.q.size(), sample.qdot.size()};
}

// What the controller remembered. Samples of earlier versions end before these.
constexpr const char* kEscapeColumns[] = {"escape_best", "escape_idle",      "stagnations", "detour_side",
                                          "detour",      "detour_remaining", "detour_x",    "detour_y",
                                          "detour_z",    "circulation"};

/// Names of the columns, in the order of flatten().
std::vector<std::string> column_names(const Sizes& sizes) {
  std::vector<std::string> names{"t", "base_x", "base_y", "base_phi"};
  for (Eigen::Index i = 0; i < sizes.q; ++i) names.push_back(fmt::format("q{}", i));
  for (Eigen::Index i = 0; i < sizes.v; ++i) names.push_back(fmt::format("qdot{}", i));
  for (Eigen::Index i = 0; i < sizes.v; ++i) names.push_back(fmt::format("command{}", i));
  for (int i = 0; i < 6; ++i) names.push_back(fmt::format("error{}", i));
  for (int i = 0; i < 6; ++i) names.push_back(fmt::format("slack{}", i));
  for (const char* name : {"manipulability", "least_distance", "status", "fallback", "active_rows"}) {
    names.emplace_back(name);
  }
  names.insert(names.end(), std::begin(kEscapeColumns), std::end(kEscapeColumns));
  return names;
}

// 2: around the obstacles.
double detour_code(const EscapeState& e) { return !e.detour ? 0.0 : e.around ? 2.0 : 1.0; }

/// One sample as numbers, in the order of column_names().
std::vector<double> flatten(const Sample& s) {
  std::vector<double> row{s.t, s.base.x(), s.base.y(), s.base.z()};
  row.insert(row.end(), s.q.begin(), s.q.end());
  row.insert(row.end(), s.qdot.begin(), s.qdot.end());
  row.insert(row.end(), s.command.begin(), s.command.end());
  row.insert(row.end(), s.error.begin(), s.error.end());
  row.insert(row.end(), s.slack.begin(), s.slack.end());
  row.insert(row.end(), {s.manipulability, s.least_distance, static_cast<double>(s.status),
                         static_cast<double>(s.fallback), static_cast<double>(s.active_rows)});
  const EscapeState& e = s.escape;
  row.insert(row.end(),
             {e.best, e.idle, static_cast<double>(e.stagnations), static_cast<double>(e.side), detour_code(e),
              e.remaining, e.target_W.x(), e.target_W.y(), e.target_W.z(), static_cast<double>(e.circulation)});
  return row;
}

/// Number of columns PREFIX0, PREFIX1, ...
Eigen::Index count_of(const std::vector<std::string>& names, const std::string& prefix) {
  Eigen::Index n = 0;
  for (const std::string& name : names) n += name == fmt::format("{}{}", prefix, n) ? 1 : 0;
  return n;
}

}  // namespace

std::vector<std::string> sample_columns(Eigen::Index q, Eigen::Index v) { return column_names({q, v}); }
std::vector<double> sample_row(const Sample& sample) { return flatten(sample); }

EncodedSamples encode_samples(const Trace& trace) {
  EncodedSamples encoded;
  encoded.n = static_cast<std::int64_t>(trace.size());
  const Sizes sizes = trace.empty() ? Sizes{} : sizes_of(trace.front());
  const std::vector<std::string> names = column_names(sizes);
  encoded.columns = nlohmann::json(names).dump();

  const std::size_t n = trace.size();
  std::vector<double> table(names.size() * n);
  for (std::size_t k = 0; k < n; ++k) {
    if (sizes_of(trace[k]) != sizes) throw std::invalid_argument("samples of one trace differ in size");
    const std::vector<double> row = flatten(trace[k]);
    for (std::size_t c = 0; c < row.size(); ++c) table[c * n + k] = row[c];
  }
  const std::size_t bytes = table.size() * sizeof(double);
  encoded.data.resize(ZSTD_compressBound(bytes));
  const std::size_t size =
      ZSTD_compress(encoded.data.data(), encoded.data.size(), table.data(), bytes, kCompressionLevel);
  if (ZSTD_isError(size) != 0U) throw std::runtime_error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  encoded.data.resize(size);
  encoded.data.shrink_to_fit();
  return encoded;
}

SampleTable decode_table(const EncodedSamples& encoded) {
  if (encoded.layout != kSamplesLayout) {
    throw std::runtime_error(fmt::format("samples have the unknown layout {}", encoded.layout));
  }
  SampleTable table;
  table.names = nlohmann::json::parse(encoded.columns).get<std::vector<std::string>>();
  const auto n = static_cast<std::uint64_t>(encoded.n);
  const std::uint64_t bytes = ZSTD_getFrameContentSize(encoded.data.data(), encoded.data.size());
  if (encoded.n < 0 || bytes > kLargestFrame || bytes != n * table.names.size() * sizeof(double)) {
    throw std::runtime_error("samples are damaged: their size does not fit");
  }
  std::vector<unsigned char> raw(bytes);
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), encoded.data.data(), encoded.data.size());
  if (ZSTD_isError(size) != 0U || size != bytes) throw std::runtime_error("samples are damaged: zstd cannot read them");
  table.columns.resize(table.names.size());
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    table.columns[c].resize(n);
    if (n > 0) std::memcpy(table.columns[c].data(), raw.data() + c * n * sizeof(double), n * sizeof(double));
  }
  return table;
}

Trace decode_samples(const EncodedSamples& encoded) {
  const SampleTable table = decode_table(encoded);
  const Sizes sizes{count_of(table.names, "q"), count_of(table.names, "qdot")};
  std::vector<std::string> known = column_names(sizes);
  const bool has_escape = table.names == known;
  if (!has_escape) known.resize(known.size() - std::size(kEscapeColumns));
  if (table.names != known) throw std::runtime_error("samples have unknown columns");
  Trace trace(static_cast<std::size_t>(encoded.n));
  for (std::size_t k = 0; k < trace.size(); ++k) {
    std::size_t c = 0;
    const auto next = [&] { return table.columns[c++][k]; };
    Sample& s = trace[k];
    s.t = next();
    for (double& value : s.base) value = next();
    s.q.resize(sizes.q);
    for (double& value : s.q) value = next();
    s.qdot.resize(sizes.v);
    for (double& value : s.qdot) value = next();
    s.command.resize(sizes.v);
    for (double& value : s.command) value = next();
    for (double& value : s.error) value = next();
    for (double& value : s.slack) value = next();
    s.manipulability = next();
    s.least_distance = next();
    s.status = static_cast<StepStatus>(std::lround(next()));
    s.fallback = static_cast<Fallback>(std::lround(next()));
    s.active_rows = static_cast<int>(std::lround(next()));
    if (!has_escape) continue;
    EscapeState& e = s.escape;
    e.best = next();
    e.idle = next();
    e.stagnations = static_cast<int>(std::lround(next()));
    e.side = static_cast<int>(std::lround(next()));
    const double detour = next();
    e.detour = detour != 0.0;
    e.around = detour == 2.0;
    e.remaining = next();
    for (double& value : e.target_W) value = next();
    e.circulation = static_cast<int>(std::lround(next()));
  }
  return trace;
}

}  // namespace moma::store
