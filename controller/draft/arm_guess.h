#pragma once

#include <string>
#include <vector>

#include "controller/draft/urdf_facts.h"

namespace moma::draft {

/// What is likely to be the arm: the longest chain of driven joints that is neither finger nor wheel.
struct ArmGuess {
  int tip = 0;                      ///< the link that carries the end effector
  std::vector<int> joints;          ///< links that the chain's driven joints move, from the root on
  std::vector<std::string> others;  ///< ends of other chains that are as long
  Vector3 p_TE = Vector3::Zero();   ///< between the fingertips where the tip is well before them
};

/// `not_arm`: links whose joints belong to the base. Of chains that are as long the one named "right" is taken, else
/// the first in the tree. The tip is the link named most like a tool among those rigid with the chain's last link.
/// `joints` is empty where nothing can be driven.
ArmGuess guess_arm(const UrdfFacts& urdf, const std::vector<bool>& not_arm);

}  // namespace moma::draft
