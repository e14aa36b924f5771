#pragma once

#include <stdexcept>
#include <string>

#include "controller/config/paths.h"

namespace moma::store {

/// An error of a store; what() is a complete message that names the file.
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

/// "FILE: message".
inline StoreError unusable(const fs::path& file, const std::string& message) {
  return {StoreError::Kind::kUnusable, file.string() + ": " + message};
}
inline StoreError of_older(const fs::path& file) {
  return unusable(file,
                  "was written by an older moma; 'moma run' on it, or 'moma merge NEW OLD', brings it up to date");
}
inline StoreError not_found(const fs::path& file, const std::string& message) {
  return {StoreError::Kind::kNotFound, file.string() + ": " + message};
}

}  // namespace moma::store
