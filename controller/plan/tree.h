#pragma once

#include <vector>

#include "controller/plan/configuration.h"

namespace moma {

/// Configurations that hang on each other, roots on nothing. Memory is taken by the constructor alone.
class Tree {
 public:
  Tree(int num_values, int capacity) : nodes_(num_values, capacity), parents_(static_cast<std::size_t>(capacity), -1) {}

  void clear() noexcept { size_ = 0; }
  int size() const noexcept { return size_; }
  bool full() const noexcept { return size_ == static_cast<int>(parents_.size()); }
  /// Index of the new node; not where the tree is full.
  int add(const WholeConfiguration& c, int parent) noexcept {
    nodes_.col(size_) = c;
    parents_[static_cast<std::size_t>(size_)] = parent;
    return size_++;
  }
  WholeConfiguration node(int i) const noexcept { return nodes_.col(i); }
  int parent(int i) const noexcept { return parents_[static_cast<std::size_t>(i)]; }
  /// The first of those nearest to c; -1 for an empty tree.
  int nearest(const WholeConfiguration& c) const noexcept;

 private:
  MatrixX nodes_;  // a column each
  std::vector<int> parents_;
  int size_ = 0;
};

}  // namespace moma
