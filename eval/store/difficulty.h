#pragma once

#include "controller/describe/describe.h"
#include "eval/trial/column.h"
#include "world/world.h"

namespace moma {

/// Columns of table `world` that say how hard it is; metrics of a trial on the report page.
template <class Visitor>
constexpr void describe(Visitor& v, Of<Difficulty>) {
  using D = Difficulty;
  v.member("goal_distance_m", &D::goal_distance_m,
           Column{.label = "goal distance", .unit = "m", .decimals = 2, .text = "from the start's tip to the goal"});
  v.member("objects", &D::objects, Column{.label = "objects", .decimals = 0, .text = "number of objects"});
  v.member("witness_clearance_m", &D::witness_clearance_m,
           Column{.label = "clearance of the witness", .unit = "m", .text = "its least distance to an object"});
  v.member("blocked_fraction", &D::blocked_fraction,
           Column{.label = "blocked part of the straight line",
                  .decimals = 2,
                  .text = "of the line from start to goal, within an object grown by 5 cm"});
  v.member("narrowest_gap_m", &D::narrowest_gap_m,
           Column{.label = "narrowest gap between objects", .unit = "m", .text = "least gap between two objects"});
}

}  // namespace moma
