#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/draft/urdf_facts.h"

namespace moma::draft {

/// A URDF's base, by its wheels or by virtual joints.
struct BaseGuess {
  BaseType type = BaseType::kFixed;
  bool doubtful = false;
  bool round = true;   ///< the wheels' shapes are round; otherwise their radius is half the least width
  std::string reason;  ///< evidence for this base, or against a fixed one; empty for a fixed base without any evidence
  Isometry X_BR = Isometry::Identity();  ///< the URDF's root R in the base frame B, which stands on the floor
  std::optional<Wheels> wheels;          ///< max_speed is 0 if the URDF has none
  /// Joints of the chain from the root that moves the whole robot, to be held.
  std::vector<std::string> virtual_joints;
  std::vector<bool> joints;  ///< per link: its joint belongs to the base
};

/// Wheels turn without limits about a level axis, are near the floor or named so, and have no driven joint behind them.
/// Casters and other parts steered about an upright axis drive nothing if other wheels do. Radii are those of the
/// collision shapes, else of the visuals, whichever is round, else the joint's height above the lowest one. Two wheels,
/// or four along one axis, make a differential base; four named mecanum or omni, three about different axes, and
/// steered wheels alone an omnidirectional one. So does a chain of joints along x and y and about z from the root,
/// without shapes before its end; with masses it is doubtful, with shapes (a gantry) a doubtful fixed base. So is a
/// root that legs or propellers seem to carry, or from which the arm hangs.
BaseGuess guess_base(const UrdfFacts& urdf);

/// The likely arm: the longest chain of driven joints that are neither fingers nor wheels.
struct ArmGuess {
  int tip = 0;                      ///< the link that carries the end effector
  std::vector<int> joints;          ///< links that the chain's driven joints move, from the root on
  std::vector<std::string> others;  ///< ends of other chains of the same length
  Vector3 p_TE = Vector3::Zero();   ///< point between the fingertips, if they are well beyond the tip
};

/// `not_arm`: links whose joints belong to the base. Among chains of the same length the one named "right" wins, else
/// the first in the tree. The tip is the link with the most tool-like name among those rigid with the chain's last
/// link. `joints` is empty if nothing can be driven.
ArmGuess guess_arm(const UrdfFacts& urdf, const std::vector<bool>& not_arm);

}  // namespace moma::draft
