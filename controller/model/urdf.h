#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma {

/// An unusable URDF: what() names the element and the fault.
class UrdfError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class UrdfJointType { kFixed, kRevolute, kContinuous, kPrismatic, kFloating, kPlanar };
constexpr auto words(Of<UrdfJointType>) {
  return std::to_array<std::string_view>({"fixed", "revolute", "continuous", "prismatic", "floating", "planar"});
}

/// value = multiplier * (value of `joint`) + offset.
struct UrdfMimic {
  std::string joint;
  double multiplier = 1.0;
  double offset = 0.0;
};

/// The joint between a link and its parent. Limits are empty if the file has none.
struct UrdfJoint {
  std::string name;
  UrdfJointType type = UrdfJointType::kFixed;
  Isometry X_PJ = Isometry::Identity();
  Vector3 axis = Vector3::UnitX();  ///< unit, in the joint frame
  std::optional<double> lower;      ///< [rad] or [m]
  std::optional<double> upper;
  std::optional<double> velocity;  ///< [rad/s] or [m/s]
  std::optional<double> effort;    ///< [Nm] or [N]
  std::optional<UrdfMimic> mimic;
};

/// One collision element of a link: a primitive, or a mesh that is not read yet.
struct UrdfGeometry {
  Shape shape;       ///< valid if `mesh` is empty
  std::string mesh;  ///< as written: package://..., file://... or a path
  Vector3 scale = Vector3::Ones();
  Isometry X_LS = Isometry::Identity();
};

struct UrdfLink {
  std::string name;
  int parent = -1;  ///< -1 for the root only
  UrdfJoint joint;  ///< unused for the root
  std::optional<Inertial> inertial;
  std::vector<UrdfGeometry> collision;
};

/// `name` is empty if the file has none. Links are in topological order: links[0] is the root, children follow in the
/// order of their joints' names.
struct UrdfTree {
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<std::string> left_out;  ///< with UrdfReading::kLenient: a sentence each, with line, link and element
};

/// Treatment of invalid shapes, masses and elements (xml_check.h).
enum class UrdfReading {
  kStrict,   ///< as errors
  kLenient,  ///< left out, and listed
};

inline constexpr std::size_t kMaxUrdfLinks = 1000;
inline constexpr std::size_t kMaxUrdfShapes = 256;  ///< collision elements

/// Reads a URDF's text through urdfdom. Reads links and joints only: visuals, materials, transmissions and simulator
/// extensions are ignored, with any faults in them. Limits may be missing. Throws UrdfError for broken XML (with row
/// and column), no or several roots, loops, a bad number, a zero axis, more than the limits above, and with kStrict any
/// other invalid element.
UrdfTree read_urdf(const std::string& text, UrdfReading reading = UrdfReading::kStrict);

/// One <visual> of a URDF: the look of a link or a part of it.
struct UrdfVisual {
  std::string link;
  UrdfGeometry geometry;
  std::optional<Vector3> colour;  ///< red, green, blue, each from 0 to 1; empty if the URDF has none
};

/// Returns the visual elements of a URDF, links in the order of read_urdf(). A material by name has the colour of the
/// first one of that name. Reads leniently: an invalid visual is left out, with its link's colours. Throws UrdfError if
/// read_urdf() does so leniently.
std::vector<UrdfVisual> read_urdf_visuals(const std::string& text);

}  // namespace moma
