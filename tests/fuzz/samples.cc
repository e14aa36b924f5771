// Samples as a store holds them: good ones whose columns, numbers or packed bytes were changed as the input says.
#include <zstd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "eval/store/samples.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/filled.h"

namespace moma {
namespace {

using store::EncodedSamples;
using store::SampleTable;

constexpr std::array<double, 12> kValues = {0.0,  -1.0,  2.0,   0.5,
                                            1e9,  -1e19, 1e308, std::numeric_limits<double>::infinity(),
                                            -1e9, 1e300, 255.0, std::numeric_limits<double>::quiet_NaN()};

SampleTable good_table() {
  Trace trace(3);
  test::Filler filler(1.0);
  for (Sample& sample : trace) filler.fill(sample);
  return store::decode_table(store::encode_samples(trace));
}

std::string text(fuzz::Bytes& choices) {
  std::string word;
  for (std::size_t n = choices.below(12); n > 0; --n) word += static_cast<char>(choices.byte());
  return word;
}

/// Changes that leave a table which fits together.
void change(SampleTable& table, fuzz::Bytes& choices) {
  const std::size_t column = choices.below(table.names.size());
  const auto place = static_cast<std::ptrdiff_t>(column);
  switch (choices.below(5)) {
    case 0:
      if (table.names.size() < 2) return;
      table.names.erase(table.names.begin() + place);
      table.columns.erase(table.columns.begin() + place);
      return;
    case 1:
      table.names.insert(table.names.begin() + place, table.names[choices.below(table.names.size())]);
      table.columns.insert(table.columns.begin() + place, std::vector<double>(table.columns[column]));
      return;
    case 2:
      table.names[column] = text(choices);
      return;
    default:
      for (double& value : table.columns[column]) value = kValues[choices.below(kValues.size())];
  }
}

EncodedSamples packed(const SampleTable& table) {
  EncodedSamples out;
  out.n = static_cast<std::int64_t>(table.columns.front().size());
  out.columns = "[";
  for (const std::string& name : table.names) {
    out.columns += out.columns.size() > 1 ? ",\"" : "\"";
    for (const char c : name)
      if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 0x20) out.columns += c;
    out.columns += '"';
  }
  out.columns += "]";
  std::vector<double> numbers;
  for (const auto& column : table.columns) numbers.insert(numbers.end(), column.begin(), column.end());
  const std::size_t bytes = numbers.size() * sizeof(double);
  out.data.resize(ZSTD_compressBound(bytes));
  out.data.resize(ZSTD_compress(out.data.data(), out.data.size(), numbers.data(), bytes, 1));
  return out;
}

/// Changes that need not fit.
void damage(EncodedSamples& samples, fuzz::Bytes& choices) {
  static constexpr std::array<std::int64_t, 8> kCounts = {0,
                                                          -1,
                                                          2,
                                                          4,
                                                          1 << 20,
                                                          std::int64_t{1} << 40,
                                                          std::numeric_limits<std::int64_t>::max(),
                                                          std::numeric_limits<std::int64_t>::min()};
  switch (choices.below(6)) {
    case 0:
      samples.n = kCounts[choices.below(kCounts.size())];
      return;
    case 1:
      samples.layout = choices.byte();
      return;
    case 2:
      samples.columns = text(choices);
      return;
    case 3:
      if (!samples.columns.empty())
        samples.columns[choices.byte() % samples.columns.size()] = static_cast<char>(choices.byte());
      return;
    case 4:
      if (!samples.data.empty())
        samples.data[(choices.byte() + std::size_t{256} * choices.byte()) % samples.data.size()] = choices.byte();
      return;
    default:
      samples.data.resize(samples.data.empty() ? 0 : choices.byte() % samples.data.size());
  }
}

}  // namespace
}  // namespace moma

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const SampleTable kGood = good_table();
  fuzz::Bytes choices(data, size);
  SampleTable table = kGood;
  for (std::size_t n = choices.below(6); n > 0; --n) change(table, choices);
  EncodedSamples samples = packed(table);
  for (std::size_t n = choices.below(4); n > 0; --n) damage(samples, choices);
  try {
    const Trace trace = store::decode_samples(samples);
    const Trace again = store::decode_samples(store::encode_samples(trace));
    if (again.size() != trace.size()) std::abort();
    for (const Sample& sample : trace)
      if (to_string(sample.status) == "?" || to_string(sample.fallback) == "?") std::abort();
  } catch (const std::runtime_error&) {
  }
  return 0;
}
