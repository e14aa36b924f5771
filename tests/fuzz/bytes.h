#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace moma::fuzz {

/// Choices made of an input's bytes, in order; zeros where they have run out.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  bool empty() const { return left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  std::size_t below(std::size_t n) { return (byte() + std::size_t{256} * (n > 256 ? byte() : 0)) % n; }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace moma::fuzz
