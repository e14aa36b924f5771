#pragma once

namespace moma::test {

/// Counts the heap allocations of this thread while it lives (malloc, calloc, realloc, aligned ones, and with them
/// operator new and Eigen). Guards nest; each counts from its own birth. Link tests/support/no_alloc.cc.
class NoAlloc {
 public:
  NoAlloc() noexcept;
  /// Allocations since this guard was made.
  int count() const noexcept;
  /// False under sanitizers, which bring their own malloc: count() is 0 then.
  static bool works() noexcept;

 private:
  int start_;
};

}  // namespace moma::test
