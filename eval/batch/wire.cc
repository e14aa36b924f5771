#include "eval/batch/wire.h"

#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "controller/config/json_node.h"
#include "controller/describe/complete.h"
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
  /// Checks booleans and words, because not every byte is a valid one.
  template <typename Number>
  void number(Number& value) {
    if constexpr (std::is_same_v<Number, bool>) {
      static_assert(sizeof(bool) == 1);
      value = below<unsigned char>(2) != 0;
    } else if constexpr (std::is_enum_v<Number>) {
      value = static_cast<Number>(below<std::underlying_type_t<Number>>(words(Of<Number>{}).size()));
    } else {
      raw(&value, sizeof value);
    }
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
  template <typename Number>
  Number below(std::size_t end) {
    Number value = 0;
    raw(&value, sizeof value);
    if (static_cast<std::size_t>(value) >= end)  // negative values become large
      throw std::runtime_error("a result from another process is damaged");
    return value;
  }
  void raw(void* data, std::size_t size) {
    if (size > left_.size()) throw std::runtime_error("a result from another process is damaged");
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_ = left_.subspan(size);
  }
  std::span<const unsigned char> left_;
};

template <typename Archive, typename Record>
void transfer(Archive& archive, Record& record);

/// Moves the members of a record's description to or from the archive.
template <typename Archive, typename Record>
class Members {
 public:
  Members(Archive& archive, Record& record) : archive_(archive), record_(record) {}
  template <typename M, typename C>
  void member(std::string_view, M C::*member, const About&) {
    put(record_.*member);
  }
  template <typename M, typename C>
  void inlined(M C::*member) {
    transfer(archive_, record_.*member);
  }

 private:
  template <typename M>
  void put(M& value) {
    if constexpr (std::is_arithmetic_v<M> || std::is_enum_v<M>) {
      archive_.number(value);
    } else if constexpr (std::is_same_v<M, std::string>) {
      archive_.text(value);
    } else if constexpr (Described<M>) {
      transfer(archive_, value);
    } else {
      archive_.numbers(value);
    }
  }
  Archive& archive_;
  Record& record_;
};

/// The description names every member of the record.
template <typename Archive, typename Record>
void transfer(Archive& archive, Record& record) {
  static_assert(is_complete<Record>());
  Members<Archive, Record> members(archive, record);
  describe(members, Of<Record>{});
}

template <typename Archive>
void transfer_profile(Archive& archive, Profile& profile) {
  for (Profile::Share& share : profile.parts) {
    archive.number(share.nanoseconds);
    archive.number(share.entries);
  }
  archive.number(profile.trials);
  archive.number(profile.steps);
}

/// Least size of a sample, one without joints: it bounds the number of samples in the rest of a message.
std::size_t least_bytes_of_a_sample() {
  Writer a;
  Sample sample;
  transfer(a, sample);
  return a.bytes.size();
}

}  // namespace

Bytes encode_result(std::uint64_t place, const BatchResult& result) {
  Writer a;
  a.number(place);
  a.text(result.world == nullptr ? std::string() : to_json(*result.world).dump());
  TrialRow row = result.output.row;
  transfer(a, row);
  a.number<std::uint64_t>(result.metrics.size());
  for (const double value : result.metrics) a.number(value);
  a.number<std::uint64_t>(result.output.trace.size());
  for (Sample sample : result.output.trace) transfer(a, sample);
  Profile profile = result.profile;
  transfer_profile(a, profile);
  return std::move(a.bytes);
}

DecodedResult decode_result(std::span<const unsigned char> bytes) {
  DecodedResult decoded;
  Reader a(bytes);
  a.number(decoded.place);
  std::string world;
  a.text(world);
  BatchResult& result = decoded.result;
  constexpr const char* kSource = "a world from another process";
  if (!world.empty())
    result.world = std::make_shared<const World>(world_from_json(config::parse_json(world, kSource), kSource));
  transfer(a, result.output.row);
  result.metrics.resize(a.size(sizeof(double)));
  for (double& value : result.metrics) a.number(value);
  result.output.trace.resize(a.size(least_bytes_of_a_sample()));
  for (Sample& sample : result.output.trace) transfer(a, sample);
  transfer_profile(a, result.profile);
  if (!a.done()) throw std::runtime_error("a result from another process is damaged");
  return decoded;
}

}  // namespace moma
