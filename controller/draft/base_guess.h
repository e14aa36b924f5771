#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/draft/urdf_facts.h"

namespace moma::draft {

/// What a URDF says of the base, by its wheels or by joints that stand for one.
struct BaseGuess {
  BaseType type = BaseType::kFixed;
  bool doubtful = false;
  bool round = true;   ///< wheels' shapes are; where not, their radius is half the least width
  std::string reason;  ///< what speaks for it, or against a fixed one; empty for a fixed base without any sign
  Isometry X_BR = Isometry::Identity();     ///< the URDF's root R in the base frame B, which stands on the floor
  std::optional<Wheels> wheels;             ///< max_speed 0 where the URDF gives none
  std::vector<std::string> virtual_joints;  ///< of the chain from the root that moves the whole robot: to be held
  std::vector<bool> joints;                 ///< per link: its joint belongs to the base
};

/// Wheels are found by joints that turn without end about a level axis, near the floor or named so, with nothing driven
/// behind them; casters and what else is steered by a joint about an upright axis drive nothing where other wheels do.
/// Radii are those of their collision shapes, else of what they look like, whichever is round, else the joint's height
/// over the lowest one.
/// Two wheels, or four along one axis, make a differential base; four that are named mecanum or omni, three about
/// different axes, and steered wheels alone make an omnidirectional one. A chain of joints along x and y and about z
/// from the root whose links have no shape before its end stands for a base as well: doubtfully where they weigh.
/// Links with shapes may be a gantry's, so that such a chain is a doubtful fixed base.
BaseGuess guess_base(const UrdfFacts& urdf);

}  // namespace moma::draft
