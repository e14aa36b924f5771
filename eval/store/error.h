#pragma once

#include <stdexcept>
#include <string>

namespace moma::store {

/// What went wrong with a store, in words for a person; what() names the file.
class StoreError : public std::runtime_error {
 public:
  enum class Kind {
    kUnusable,       ///< not a store, cannot be opened or written at all
    kInterrupted,    ///< stopped working during a run (disk full, locked, I/O): what was committed is safe
    kContradiction,  ///< the same key with two different results
    kNotFound,       ///< no such trial, suite or name
  };
  StoreError(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const noexcept { return kind_; }

 private:
  Kind kind_;
};

}  // namespace moma::store
