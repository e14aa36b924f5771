#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "controller/config/package_path.h"
#include "controller/model/urdf.h"
#include "controller/model/urdf_visual.h"

namespace moma::draft {

/// A URDF's tree with what guesses ask of it again and again. Link i is tree.links[i], 0 the root R.
struct UrdfFacts {
  UrdfTree tree;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_RL;  ///< of the links, all joints at 0
  std::vector<std::vector<int>> children;
  std::vector<UrdfVisual> visuals;
  std::filesystem::path directory;                        ///< of the URDF
  std::map<std::string, std::filesystem::path> packages;  ///< that are to be named in the robot file
  std::vector<std::string> renamed;                       ///< of `packages` those whose folder is called otherwise

  const UrdfLink& link(int i) const { return tree.links[static_cast<std::size_t>(i)]; }
  const Isometry& X_R(int i) const { return X_RL[static_cast<std::size_t>(i)]; }
  const std::vector<int>& children_of(int i) const { return children[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(tree.links.size()); }
  /// Axis of the joint that moves link i, in R.
  Vector3 axis_R(int i) const { return X_R(i).linear() * link(i).joint.axis; }
};

/// `text`: the URDF, in `directory`. Packages of its meshes that stand neither beside nor above it are looked for as
/// always, then as a folder above it that has the mesh, whatever its name.
UrdfFacts facts_of(const std::string& text, UrdfReading reading, const std::filesystem::path& directory);

/// Points on the outline of a shape, in the link's frame: vertices of a mesh, corners of a box, rings of what is round.
/// Empty where a mesh cannot be read; what is wrong with it is said where the robot's shapes are read.
std::vector<Vector3> outline(const UrdfFacts& urdf, const UrdfGeometry& shape);

/// Revolute, continuous or prismatic, and free to be driven: it mimics no other.
bool drivable(const UrdfJoint& joint);

/// Whether a name has one of the words in it, whatever the case of its letters.
bool named(std::string_view name, std::initializer_list<std::string_view> words);

}  // namespace moma::draft
