#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "eval/suite/suite.h"
#include "python/bindings/bindings.h"

namespace moma::python {

/// A suite as Python holds it.
class Suite {
 public:
  explicit Suite(moma::Suite suite) : suite_(std::make_shared<const moma::Suite>(std::move(suite))) {}

  const moma::Suite& get() const noexcept { return *suite_; }
  /// Throws std::invalid_argument where there is none of that number.
  const SuitePoint& point(std::size_t i) const;

 private:
  std::shared_ptr<const moma::Suite> suite_;
};

/// World `index` of a point. Throws GenerationError.
World make_world(const SuitePoint& point, std::uint64_t index);

}  // namespace moma::python
