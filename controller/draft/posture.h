#pragma once

#include "controller/model/robot_model.h"

namespace moma::draft {

struct Posture {
  VectorX q;
  double manipulability = 0.0;  ///< of translation
  bool clear = false;           ///< free of contacts with itself or the floor that most configurations do not have
  bool held = false;            ///< all joints with a known effort can hold the arm, with a margin of a tenth
};

enum class PostureFor {
  kReady,   ///< a posture to work from
  kFolded,  ///< a posture to hold while another arm works: close to the body, especially ahead of it
};

/// Searches 2,000 configurations within nine tenths of the limits (a Halton sequence, always the same), clear ones
/// that can be held first, then clear ones, then held ones. For kReady it maximises the product of manipulability and
/// distance to the nearest limit, halved if E is behind the base or near the floor; for kFolded it minimises the spread
/// of the shapes about the base's middle. Rounded to hundredths. `model` needs shapes, no pairs.
Posture find_posture(const RobotModel& model, PostureFor what = PostureFor::kReady);

}  // namespace moma::draft
