#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/store/field.h"
#include "eval/trial/row.h"

namespace moma::store {

inline constexpr int kSamplesLayout = 1;

/// A trace as table `samples` holds it (store.md): names of the columns, and one zstd frame with the columns
/// one after the other, each as n little-endian doubles.
struct EncodedSamples {
  int layout = kSamplesLayout;
  std::int64_t n = 0;
  std::string columns;
  Blob data;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<EncodedSamples>) {
  using T = EncodedSamples;
  v.member("layout", &T::layout, Field{});
  v.member("n", &T::n, Field{.text = "samples"});
  v.member("columns", &T::columns, Field{.text = "names, in order", .json = true});
  v.member("data", &T::data, Field{});
}

/// Names of the columns for `q` joints and `v` velocities, and one sample as numbers in their order.
std::vector<std::string> sample_columns(Eigen::Index q, Eigen::Index v);
/// Adds to the names of some sample's columns those that this moma writes for the same robot and they lack.
void add_written_columns(std::vector<std::string>& names);
std::vector<double> sample_row(const Sample& sample);

/// All samples must have vectors of the same sizes. Throws std::invalid_argument otherwise.
EncodedSamples encode_samples(const Trace& trace);

/// Columns by name, each with n values.
struct SampleTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
};

/// The list of names in column `columns` of table samples. Throws std::runtime_error where it is none.
std::vector<std::string> column_names_of(const std::string& json);

/// Throws std::runtime_error where the data is damaged, of an unknown layout, or more than 512 MiB, before it asks for
/// memory.
SampleTable decode_table(const EncodedSamples& encoded);
/// The same bits that were encoded.
Trace decode_samples(const EncodedSamples& encoded);

}  // namespace moma::store
