#pragma once

#include <vector>

#include "controller/plan/configuration.h"

namespace moma {

/// A tree of configurations with one or several roots. Only the constructor allocates.
class Tree {
 public:
  Tree(int num_values, int capacity) : nodes_(num_values, capacity), parents_(static_cast<std::size_t>(capacity), -1) {}

  void clear() noexcept { size_ = 0; }
  int size() const noexcept { return size_; }
  bool full() const noexcept { return size_ == static_cast<int>(parents_.size()); }
  /// Returns the new node's index. The tree must not be full. `parent`: -1 for a root.
  int add(const WholeConfiguration& c, int parent) noexcept {
    nodes_.col(size_) = c;
    parents_[static_cast<std::size_t>(size_)] = parent;
    return size_++;
  }
  WholeConfiguration node(int i) const noexcept { return nodes_.col(i); }
  int parent(int i) const noexcept { return parents_[static_cast<std::size_t>(i)]; }
  /// Returns the node nearest to c, the first of equal ones; -1 for an empty tree.
  int nearest(const WholeConfiguration& c) const noexcept;

 private:
  MatrixX nodes_;  // a column each
  std::vector<int> parents_;
  int size_ = 0;
};

}  // namespace moma
