#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/store/field.h"
#include "eval/trial/row.h"

namespace moma::store {

inline constexpr int kSamplesLayout = 1;

/// A trace as in table `samples` (store.md): column names, and a zstd frame with the columns one after the other, each
/// as n little-endian doubles.
struct EncodedSamples {
  int layout = kSamplesLayout;
  std::int64_t n = 0;
  std::string columns;
  Blob data;
};

constexpr void describe(auto& v, Of<EncodedSamples>) {
  using T = EncodedSamples;
  v.member("layout", &T::layout, Field{});
  v.member("n", &T::n, Field{.text = "samples"});
  v.member("columns", &T::columns, Field{.text = "names, in order", .json = true});
  v.member("data", &T::data, Field{});
}

/// Column names for `q` joints and `v` velocities in worlds where no object gives way; and one sample as numbers in
/// this order, times of objects that give way last.
std::vector<std::string> sample_columns(Eigen::Index q, Eigen::Index v);
/// Adds the missing names of columns that this version writes for the same robot.
void add_written_columns(std::vector<std::string>& names);
std::vector<double> sample_row(Sample sample);

/// All samples must have vectors of the same sizes. Throws std::invalid_argument otherwise.
EncodedSamples encode_samples(const Trace& trace);

/// Columns by name, each with n values.
struct SampleTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
};

/// Reads column `columns` of table samples. Throws std::runtime_error if it is no list of names.
std::vector<std::string> column_names_of(const std::string& json);

/// Throws std::runtime_error for damaged data, an unknown layout, or more than 512 MiB, before allocating.
SampleTable decode_table(const EncodedSamples& encoded);
/// The same bits that were encoded.
Trace decode_samples(const EncodedSamples& encoded);

}  // namespace moma::store
