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

/// Lets the n-th allocation of this thread from now fail (n from 1), while it lives. Not under sanitizers.
class FailingAlloc {
 public:
  explicit FailingAlloc(int n) noexcept;
  ~FailingAlloc();
  FailingAlloc(const FailingAlloc&) = delete;
  FailingAlloc& operator=(const FailingAlloc&) = delete;
  /// Whether it has.
  bool failed() const noexcept;
};

}  // namespace moma::test
