#pragma once

#include <string_view>
#include <vector>

#include "controller/model/urdf.h"

namespace moma::draft {

/// A URDF's tree with what guesses ask of it again and again. Link i is tree.links[i], 0 the root R.
struct UrdfFacts {
  UrdfTree tree;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_RL;  ///< of the links, all joints at 0
  std::vector<std::vector<int>> children;

  const UrdfLink& link(int i) const { return tree.links[static_cast<std::size_t>(i)]; }
  const Isometry& X_R(int i) const { return X_RL[static_cast<std::size_t>(i)]; }
  const std::vector<int>& children_of(int i) const { return children[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(tree.links.size()); }
  /// Axis of the joint that moves link i, in R.
  Vector3 axis_R(int i) const { return X_R(i).linear() * link(i).joint.axis; }
};

UrdfFacts facts_of(UrdfTree tree);

/// Revolute, continuous or prismatic, and free to be driven: it mimics no other.
bool drivable(const UrdfJoint& joint);

/// Whether a name has one of the words in it, whatever the case of its letters.
bool named(std::string_view name, std::initializer_list<std::string_view> words);

}  // namespace moma::draft
