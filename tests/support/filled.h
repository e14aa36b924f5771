#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "controller/describe/complete.h"
#include "controller/types.h"

namespace moma::test {

/// Gives every member that a record's description names a value of its own; no vector of them is empty.
class Filler {
 public:
  explicit Filler(double first) : next_(first) {}

  template <class T>
  void fill(T& record) {
    Members<T> members{*this, record};
    describe(members, Of<T>{});
  }

 private:
  template <class T>
  struct Members {
    Filler& filler;
    T& record;
    template <class M>
    void member(std::string_view name, M T::*member, const About&) {
      filler.set(name, record.*member);
    }
    template <class M>
    void inlined(M T::*member) {
      filler.fill(record.*member);
    }
  };

  template <class M>
  void set(std::string_view name, M& value) {
    next_ += 1.0;
    if constexpr (std::is_same_v<M, bool>) {
      value = true;
    } else if constexpr (std::is_enum_v<M>) {
      value = static_cast<M>(1);
    } else if constexpr (std::is_integral_v<M>) {
      value = static_cast<M>(next_);
    } else if constexpr (std::is_floating_point_v<M>) {
      value = next_ + 1.0 / 3.0;
    } else if constexpr (std::is_same_v<M, std::string>) {
      value = std::string(name) + " " + std::to_string(next_);
    } else if constexpr (Described<M>) {
      fill(value);
    } else {
      if (value.size() == 0) value.resize(3);
      for (double& number : value) number = next_ += 0.125;
    }
  }
  double next_;
};

/// All that a record's description names, as text that differs where a bit differs.
template <class T>
std::string bits_of(const T& record);

template <class T>
struct BitsOf {
  const T& record;
  std::string text = {};

  template <class M>
  void member(std::string_view name, M T::*member, const About&) {
    add(name, record.*member);
  }
  template <class M>
  void inlined(M T::*member) {
    if (with_inlined) text += bits_of(record.*member);
  }
  bool with_inlined = true;

 private:
  template <class M>
  void add(std::string_view name, const M& value) {
    text += std::string(name) + "=";
    if constexpr (std::is_same_v<M, std::string>) {
      text += value;
    } else if constexpr (std::is_enum_v<M> || std::is_integral_v<M>) {
      text += std::to_string(static_cast<long long>(value));
    } else if constexpr (std::is_floating_point_v<M>) {
      text += std::to_string(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (Described<M>) {
      text += bits_of(value);
    } else {
      for (const double number : value) text += std::to_string(std::bit_cast<std::uint64_t>(number)) + ",";
    }
    text += "\n";
  }
};

template <class T>
std::string bits_of(const T& record) {
  BitsOf<T> bits{record};
  describe(bits, Of<T>{});
  return bits.text;
}

/// The same without what is inlined: a row without its timings.
template <class T>
std::string own_bits_of(const T& record) {
  BitsOf<T> bits{record};
  bits.with_inlined = false;
  describe(bits, Of<T>{});
  return bits.text;
}

}  // namespace moma::test
