#pragma once

#include <cstdint>
#include <vector>

#include "eval/suite/suite.h"
#include "eval/trial/row.h"

namespace moma {

/// The sequential rule of `trials: {until: ...}`.
///
/// Worlds come in blocks of `block`, with all points in every world. At the end of each block, and at no other moment,
/// each point's rate of the metric over all worlds so far gets a Wilson interval (95 %). The rule ends the run once the
/// widest interval of all points has at most the half-width, or after `max` worlds. The decision therefore depends on
/// the rows alone: not on threads, stops and resumes, or other contents of the store.
///
/// Looking several times at one growing sample costs some coverage; store.md has the exact numbers, which
/// tests/eval/cluster_parts_test.cc computes.
class SequentialRule {
 public:
  SequentialRule(const UntilRule& rule, std::size_t points);

  /// Number of worlds of the next block; 0 at the end.
  std::uint64_t next_block() const;
  void add(std::size_t point, Outcome outcome);
  /// Ends the block; call it after all rows of the block.
  void end_block(std::uint64_t worlds);

  std::uint64_t worlds() const { return worlds_; }
  /// Half the width of the widest interval; 0.5 before the first block.
  double half_width() const { return half_width_; }
  bool reached() const { return half_width_ <= rule_.half_width; }

 private:
  UntilRule rule_;
  std::vector<std::int64_t> hits_;
  std::uint64_t worlds_ = 0;
  double half_width_ = 0.5;
};

}  // namespace moma
