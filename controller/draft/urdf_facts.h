#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "controller/config/package_path.h"
#include "controller/model/urdf.h"

namespace moma::draft {

/// A URDF's tree with the quantities that the guesses need repeatedly. Link i is tree.links[i], 0 the root R.
struct UrdfFacts {
  UrdfTree tree;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_RL;  ///< pose of the links, all joints at 0
  std::vector<std::vector<int>> children;
  std::vector<UrdfVisual> visuals;
  config::PackagePaths packages;     ///< named: those that the robot file has to name
  std::vector<std::string> renamed;  ///< packages among them whose folder has another name

  const UrdfLink& link(int i) const { return tree.links[static_cast<std::size_t>(i)]; }
  const Isometry& X_R(int i) const { return X_RL[static_cast<std::size_t>(i)]; }
  const std::vector<int>& children_of(int i) const { return children[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(tree.links.size()); }
  /// Axis of the joint that moves link i, in R.
  Vector3 axis_R(int i) const { return X_R(i).linear() * link(i).joint.axis; }
};

/// `text`: the URDF, in `directory`. Packages of its meshes that are neither beside nor above it are searched as usual,
/// then as any folder above it that contains the mesh.
UrdfFacts facts_of(const std::string& text, UrdfReading reading, const fs::path& directory);

/// Returns points on the outline of a shape, in the link's frame: vertices of a mesh, corners of a box, rings of round
/// shapes. Empty if a mesh cannot be read; the reader of the robot's shapes reports the error.
std::vector<Vector3> outline(const UrdfFacts& urdf, const UrdfGeometry& shape);

/// True if a joint is revolute, continuous or prismatic, and mimics no other.
bool drivable(const UrdfJoint& joint);

/// True if a name contains one of the words, in any case.
bool named(std::string_view name, std::initializer_list<std::string_view> words);

}  // namespace moma::draft
