#pragma once

#include <string>
#include <vector>

#include "controller/draft/urdf_facts.h"

namespace moma::draft {

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
