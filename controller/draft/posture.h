#pragma once

#include <memory>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma::draft {

/// A posture for `ready`, and what it has.
struct Posture {
  VectorX q;
  double manipulability = 0.0;  ///< of translation
  bool clear = false;           ///< nothing touches itself or the floor that does not in most configurations
  bool held = false;            ///< all joints with a known effort can hold the arm there, with a tenth to spare
};

enum class PostureFor {
  kReady,   ///< to work from
  kFolded,  ///< to be held in while another arm works: close to the body, above all ahead of it
};

/// Of `samples` configurations within nine tenths of the limits (a Halton sequence: the same each time) that where the
/// arm is clear of itself, its base and the floor and can be held, with the largest product of manipulability and room
/// to the nearest limit, where half as much counts with E behind the base, or so low that it reaches for the floor; to
/// be folded, with the least spread of its shapes about the base's middle.
/// Rounded to hundredths. Where no sample is clear and held, clear ones come before held ones. `model` needs shapes, no
/// pairs.
Posture find_posture(const RobotModel& model, PostureFor what = PostureFor::kReady, int samples = 2000);

}  // namespace moma::draft
