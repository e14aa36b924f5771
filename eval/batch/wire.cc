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

[[noreturn]] void damaged() { throw std::runtime_error("a result from another process is damaged"); }

/// A message: its values are written one after the other, or read back by the same calls.
class Archive {
 public:
  Archive() = default;  ///< writes
  explicit Archive(std::span<const unsigned char> message) : reads_(true), left_(message) {}

  /// Booleans and words are checked, because not every byte is a valid one.
  template <typename Number>
  void number(Number& value) {
    if constexpr (std::is_same_v<Number, bool>) {
      value = code<unsigned char>(value, 2) != 0;
    } else if constexpr (std::is_enum_v<Number>) {
      value = static_cast<Number>(code(static_cast<std::underlying_type_t<Number>>(value), words(Of<Number>{}).size()));
    } else {
      static_assert(std::is_arithmetic_v<Number>);
      raw(&value, sizeof value);
    }
  }
  void text(std::string& value) {
    resize(value, 1);
    raw(value.data(), value.size());
  }
  void numbers(VectorX& value) {
    resize(value, sizeof(double));
    raw(value.data(), static_cast<std::size_t>(value.size()) * sizeof(double));
  }
  template <int n>
  void numbers(Eigen::Matrix<double, n, 1>& value) {
    raw(value.data(), sizeof(double) * n);
  }
  /// Its size, and so many items on reading. `least`: bytes that an item takes at least.
  template <typename List>
  void resize(List& list, std::size_t least) {
    auto size = static_cast<std::uint64_t>(list.size());
    number(size);
    if (reads_ && size > left_.size() / least) damaged();
    if (reads_) list.resize(static_cast<decltype(list.size())>(size));
  }
  bool done() const { return left_.empty(); }
  Bytes bytes;

 private:
  template <typename Code>
  Code code(Code value, std::size_t end) {
    raw(&value, sizeof value);
    if (static_cast<std::size_t>(value) >= end) damaged();  // negative values become large
    return value;
  }
  void raw(void* data, std::size_t size) {
    if (!reads_) {
      const auto* begin = static_cast<const unsigned char*>(data);
      bytes.insert(bytes.end(), begin, begin + size);
      return;
    }
    if (size > left_.size()) damaged();
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_ = left_.subspan(size);
  }
  bool reads_ = false;
  std::span<const unsigned char> left_;
};

template <typename Record>
void transfer(Archive& archive, Record& record);

/// Moves the members of a record's description to or from the archive.
template <typename Record>
class Members {
 public:
  Members(Archive& archive, Record& record) : archive_(archive), record_(record) {}
  template <typename M, typename C>
  void member(std::string_view, M C::*member, const About&) {
    M& value = record_.*member;
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
  template <typename M, typename C>
  void inlined(M C::*member) {
    transfer(archive_, record_.*member);
  }

 private:
  Archive& archive_;
  Record& record_;
};

/// The description names every member of the record.
template <typename Record>
void transfer(Archive& archive, Record& record) {
  static_assert(is_complete<Record>());
  Members<Record> members(archive, record);
  describe(members, Of<Record>{});
}

/// Least size of a sample, one without joints: it bounds the number of samples in the rest of a message.
std::size_t least_bytes_of_a_sample() {
  Archive a;
  Sample sample;
  transfer(a, sample);
  return a.bytes.size();
}

/// `world`: its text, "" where there is none.
void transfer(Archive& a, std::uint64_t& place, std::string& world, BatchResult& result) {
  a.number(place);
  a.text(world);
  transfer(a, result.output.row);
  a.resize(result.metrics, sizeof(double));
  for (double& value : result.metrics) a.number(value);
  a.resize(result.output.trace, least_bytes_of_a_sample());
  for (Sample& sample : result.output.trace) transfer(a, sample);
  for (Profile::Share& share : result.profile.parts) {
    a.number(share.nanoseconds);
    a.number(share.entries);
  }
  a.number(result.profile.trials);
  a.number(result.profile.steps);
}

}  // namespace

Bytes encode_result(std::uint64_t place, const BatchResult& result) {
  Archive a;
  std::string world = result.world == nullptr ? "" : to_json(*result.world).dump();
  BatchResult copy = result;
  transfer(a, place, world, copy);
  return std::move(a.bytes);
}

DecodedResult decode_result(std::span<const unsigned char> bytes) {
  DecodedResult decoded;
  Archive a(bytes);
  std::string world;
  transfer(a, decoded.place, world, decoded.result);
  if (!a.done()) damaged();
  constexpr const char* kSource = "a world from another process";
  if (!world.empty())
    decoded.result.world = std::make_shared<const World>(world_from_json(config::parse_json(world, kSource), kSource));
  return decoded;
}

}  // namespace moma
