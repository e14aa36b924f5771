#include "eval/store/samples.h"

#include <fmt/format.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "controller/describe/complete.h"

namespace moma::store {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are stored little-endian");

constexpr int kCompressionLevel = 3;
// Limits of an unpacked table, against hostile stores: hours of samples, and more columns than any robot has.
constexpr std::uint64_t kLargestTable = std::uint64_t{512} << 20;  // bytes
constexpr std::size_t kMostColumns = 4096;
constexpr std::size_t kLongestColumns = std::size_t{1} << 20;  // bytes of JSON

struct Sizes {
  Eigen::Index q = 0;
  Eigen::Index v = 0;
  Eigen::Index giving_way = 0;  // objects
  bool operator==(const Sizes&) const = default;
};

Sizes sizes_of(const Sample& sample) {
  if (sample.command.size() != sample.qdot.size()) {
    throw std::invalid_argument("a sample's qdot and command differ in size");
  }
  return {sample.q.size(), sample.qdot.size(), sample.object_time.size()};
}

/// Name of a column, put together only where it is wanted.
struct ColumnName {
  std::string_view prefix;
  std::string_view stem;
  int index = -1;         ///< of a component; -1: none
  std::string_view part;  ///< of a component that has a name

  std::string text() const {
    if (!part.empty()) return fmt::format("{}{}_{}", prefix, stem, part);
    return index < 0 ? fmt::format("{}{}", prefix, stem) : fmt::format("{}{}{}", prefix, stem, index);
  }
};

/// Columns of simulation version 12 and before, which have no member any more.
constexpr std::string_view kFormerColumns[] = {"circulation", "plan_detour", "plan_time_detour"};

/// Name of the column of a member of the controller's memory: the historical name for the first ones, and for
/// any later one escape_NAME.
ColumnName memory_column(std::string_view member) {
  constexpr std::pair<std::string_view, std::string_view> kNames[] = {{"stagnations", "stagnations"},
                                                                      {"side", "detour_side"},
                                                                      {"detour", "detour"},
                                                                      {"remaining", "detour_remaining"},
                                                                      {"target", "detour"}};
  for (const auto& [name, column] : kNames)
    if (name == member) return {"", column, -1, ""};
  return {"escape_", member, -1, ""};
}

/// A whole number from a store, from `least` to `most`.
template <class M>
M whole(const ColumnName& name, double number, double least, double most) {
  if (!(number >= least && number <= most) || number != std::trunc(number))
    throw std::runtime_error(fmt::format("samples are damaged: a value of {} is {}", name.text(), number));
  return static_cast<M>(number);
}

/// Visits the numbers of a sample with the names of their columns, in their order: `number(name, value, is_memory)`.
template <class Number>
class Numbers {
 public:
  Numbers(Sample& sample, const Number& number) : sample_(sample), number_(number) {}

  template <class M>
  void member(std::string_view name, M Sample::*member, const SampleColumn& about) {
    if constexpr (std::is_same_v<M, EscapeState>) {
      describe(*this, Of<EscapeState>{});
    } else if constexpr (std::is_same_v<M, PlanBrief>) {
      describe(*this, Of<PlanBrief>{});
    } else {
      value({"", name, -1, ""}, sample_.*member, about.parts, false);
    }
  }
  template <class M>
  void member(std::string_view name, M EscapeState::*member, const About&) {
    if constexpr (std::is_same_v<M, bool>) {  // 2 in simulation version 12 and before: a detour around the obstacles
      double code = sample_.escape.*member ? 1.0 : 0.0;
      number_(memory_column(name), code, true);
      sample_.escape.*member = whole<int>(memory_column(name), code, 0.0, 2.0) != 0;
    } else {
      value(memory_column(name), sample_.escape.*member, "x y z", true);
    }
  }
  template <class M>
  void member(std::string_view name, M PlanBrief::*member, const About&) {
    value({"plan_", name, -1, ""}, sample_.plan.*member, "x y phi", true);
  }
  void inlined(PlanVerdict PlanBrief::*) { describe(*this, Of<PlanVerdict>{}); }
  template <class M>
  void member(std::string_view name, M PlanVerdict::*member, const About&) {
    value({"plan_", name, -1, ""}, sample_.plan.choice.*member, "", true);
  }

  template <class M>
  void value(ColumnName name, M& member, std::string_view parts, bool memory) {
    if constexpr (std::is_same_v<M, double>) {
      number_(name, member, memory);
    } else if constexpr (std::is_enum_v<M>) {
      auto number = static_cast<double>(member);
      number_(name, number, memory);
      member = whole<M>(name, number, 0.0, static_cast<double>(words(Of<M>{}).size()) - 1.0);
    } else if constexpr (std::is_arithmetic_v<M>) {
      auto number = static_cast<double>(member);
      number_(name, number, memory);
      member = whole<M>(name, number, std::numeric_limits<M>::lowest(), std::numeric_limits<M>::max());
    } else {
      for (double& number : member) {
        ++name.index;
        const std::size_t end = std::min(parts.find(' '), parts.size());
        name.part = parts.substr(0, end);
        parts.remove_prefix(std::min(end + 1, parts.size()));
        number_(name, number, memory);
      }
    }
  }

 private:
  Sample& sample_;
  const Number& number_;
};

template <class Number>
void visit_numbers(Sample& sample, const Number& number) {
  static_assert(is_complete<Sample>() && is_complete<EscapeState>() && is_complete<PlanBrief>() &&
                is_complete<PlanVerdict>());
  Numbers<Number> numbers(sample, number);
  describe(numbers, Of<Sample>{});
}

Sample sized(const Sizes& sizes) {
  Sample sample;
  sample.q = VectorX::Zero(sizes.q);
  sample.qdot = sample.command = VectorX::Zero(sizes.v);
  sample.object_time = VectorX::Zero(sizes.giving_way);
  return sample;
}

/// Names of the columns, in the order of sample_row().
std::vector<std::string> names_of(const Sizes& sizes) {
  std::vector<std::string> names;
  Sample sample = sized(sizes);
  visit_numbers(sample, [&](const ColumnName& name, double&, bool) { names.push_back(name.text()); });
  return names;
}

/// Number of columns PREFIX0, PREFIX1, ...
Eigen::Index count_of(const std::vector<std::string>& names, const std::string& prefix) {
  Eigen::Index n = 0;
  for (const std::string& name : names) n += name == fmt::format("{}{}", prefix, n) ? 1 : 0;
  return n;
}

Sizes sizes_of(const std::vector<std::string>& names) {
  return {count_of(names, "q"), count_of(names, "qdot"), count_of(names, "object_time")};
}

}  // namespace

void add_written_columns(std::vector<std::string>& names) {
  for (std::string& name : names_of(sizes_of(names)))
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
}

std::vector<std::string> sample_columns(Eigen::Index q, Eigen::Index v) { return names_of({q, v, 0}); }
std::vector<double> sample_row(Sample s) {
  std::vector<double> row;
  visit_numbers(s, [&](const ColumnName&, double& value, bool) { row.push_back(value); });
  return row;
}

EncodedSamples encode_samples(const Trace& trace) {
  EncodedSamples encoded;
  encoded.n = static_cast<std::int64_t>(trace.size());
  const Sizes sizes = trace.empty() ? Sizes{} : sizes_of(trace.front());
  const std::vector<std::string> names = names_of(sizes);
  encoded.columns = nlohmann::json(names).dump();

  const std::size_t n = trace.size();
  if (n > kLargestTable / sizeof(double) / names.size()) {
    throw std::runtime_error(
        fmt::format("a trial has {} samples of {} numbers: more than the {} MiB that a store keeps "
                    "of one trial; a longer control period, or 'samples: none', cures it",
                    n, names.size(), kLargestTable >> 20));
  }
  std::vector<double> table(names.size() * n);
  for (std::size_t k = 0; k < n; ++k) {
    if (sizes_of(trace[k]) != sizes) throw std::invalid_argument("samples of one trace differ in size");
    const std::vector<double> row = sample_row(trace[k]);
    for (std::size_t c = 0; c < row.size(); ++c) table[c * n + k] = row[c];
  }
  const std::size_t bytes = table.size() * sizeof(double);
  encoded.data.resize(ZSTD_compressBound(bytes));
  const std::size_t size =
      ZSTD_compress(encoded.data.data(), encoded.data.size(), table.data(), bytes, kCompressionLevel);
  if (ZSTD_getErrorCode(size) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(size) != 0U) throw std::runtime_error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  encoded.data.resize(size);
  encoded.data.shrink_to_fit();
  return encoded;
}

std::vector<std::string> column_names_of(const std::string& json) {
  std::vector<std::string> names;
  if (json.size() <= kLongestColumns) {
    // A list of words is flat: the parser skips nested values.
    const auto flat = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) { return depth <= 1; };
    const auto list = nlohmann::json::parse(json, flat, false);
    const bool words =
        list.is_array() && std::all_of(list.begin(), list.end(), [](const auto& name) { return name.is_string(); });
    if (words) names = list.get<std::vector<std::string>>();
  }
  if (names.empty() || names.size() > kMostColumns)
    throw std::runtime_error(
        fmt::format("samples are damaged: their columns are no list of 1 to {} names", kMostColumns));
  return names;
}

SampleTable decode_table(const EncodedSamples& encoded) {
  if (encoded.layout != kSamplesLayout) {
    throw std::runtime_error(fmt::format("samples have the unknown layout {}", encoded.layout));
  }
  SampleTable table;
  table.names = column_names_of(encoded.columns);
  const std::size_t columns = table.names.size();
  if (encoded.n < 0 || static_cast<std::uint64_t>(encoded.n) > kLargestTable / sizeof(double) / columns) {
    throw std::runtime_error(
        fmt::format("samples are damaged: {} samples of {} columns are more than the {} MiB that a "
                    "trial may have",
                    encoded.n, columns, kLargestTable >> 20));
  }
  const auto n = static_cast<std::uint64_t>(encoded.n);
  const std::uint64_t bytes = ZSTD_getFrameContentSize(encoded.data.data(), encoded.data.size());
  if (bytes != n * columns * sizeof(double)) throw std::runtime_error("samples are damaged: their size does not fit");
  std::vector<unsigned char> raw(bytes);
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), encoded.data.data(), encoded.data.size());
  if (ZSTD_getErrorCode(size) == ZSTD_error_memory_allocation) throw std::bad_alloc();
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
  // Samples of earlier versions lack some or all columns of the controller's memory.
  std::vector<int> places;
  std::size_t used = 0;
  Sample sample = sized(sizes_of(table.names));
  visit_numbers(sample, [&](const ColumnName& column, double&, bool memory) {
    const std::string name = column.text();
    const auto found = std::ranges::find(table.names, name);
    const bool there = found != table.names.end();
    if (!there && !memory) throw std::runtime_error("samples have no column " + name);
    places.push_back(there ? static_cast<int>(found - table.names.begin()) : -1);
    used += there ? 1 : 0;
  });
  for (const std::string_view former : kFormerColumns)
    used += static_cast<std::size_t>(std::ranges::count(table.names, former));
  if (used != table.names.size()) throw std::runtime_error("samples have unknown columns");
  Trace trace(static_cast<std::size_t>(encoded.n), sample);
  for (std::size_t k = 0; k < trace.size(); ++k) {
    std::size_t c = 0;
    visit_numbers(trace[k], [&](const ColumnName&, double& value, bool) {
      const int place = places[c++];
      if (place >= 0) value = table.columns[static_cast<std::size_t>(place)][k];
    });
  }
  return trace;
}

}  // namespace moma::store
