#pragma once

#include <numbers>

#include "controller/describe/describe.h"

namespace moma {

/// Log-odds of occupancy for a hit and for a ray that passes, and their bounds: the defaults are those of Hornung,
/// Wurm, Bennewitz, Stachniss & Burgard, "OctoMap", Autonomous Robots 34, 2013, section 5. Kept in steps of 0.05.
struct EvidenceParams {
  double hit = 0.85;
  double pass = 0.4;
  double least = 2.0;  ///< lower bound, sign changed
  double most = 3.5;
};

constexpr void describe(auto& v, Of<EvidenceParams>) {
  using T = EvidenceParams;
  constexpr Range kLogOdds{0.05, 6.0};
  v.member("hit", &T::hit, in_range(kLogOdds, "1", "log-odds that a ray's end adds to its cell"));
  v.member("pass", &T::pass, in_range(kLogOdds, "1", "log-odds that a passing ray takes from a cell"));
  v.member("least", &T::least, in_range(kLogOdds, "1", "lower bound of a cell's log-odds, sign changed"));
  v.member("most", &T::most, in_range(kLogOdds, "1", "upper bound of a cell's log-odds"));
}

/// Space that no sensor has seen: the robot stops in front of it, and ways lead around what is near.
struct UnseenParams {
  bool enabled = false;
  double start = 0.15;      ///< distance from the robot's first place up to which space counts as free [m]
  double beside = 0.15;     ///< the same from the middle of a cell to the box of its base [m]
  double influence = 0.15;  ///< distance below which a pair has a row [m]
  double stop = 0.0;        ///< stop distance of these rows [m]
  double margin = 0.0;      ///< distance kept on the braking trajectory [m]
  double range = 0.5;       ///< distance from the robot up to which unseen space counts [m]
  double around = 0.01;     ///< depth up to which ways may enter it while one is found [m]; 0: they go through it
  double facing = 0.0;      ///< turning that a base prefers to a drive backwards, if no sensor looks there [rad]
  double least = 0.0;       ///< edge of the smallest cube of it that counts [m]
  double behind = 0.0;      ///< depth behind the ends of rays up to which smaller pockets count, too [m]
  int boxes = 160;          ///< most boxes
};

constexpr void describe(auto& v, Of<UnseenParams>) {
  using T = UnseenParams;
  v.member("start", &T::start,
           non_negative("m", "distance from the robot's first place up to which space counts as free"));
  v.member("beside", &T::beside,
           unless_default(non_negative("m", "the same from the middle of a cell to the box of the robot's base")));
  v.member("influence", &T::influence, positive("m", "distance below which unseen space has a row"));
  v.member("stop", &T::stop, non_negative("m", "stop distance of these rows"));
  v.member("margin", &T::margin, non_negative("m", "distance kept on the braking trajectory"));
  v.member("range", &T::range, positive("m", "distance from the robot up to which unseen space counts"));
  v.member("around", &T::around,
           non_negative("m", "depth up to which ways may enter unseen space, unless all go through it; 0: they do"));
  v.member("facing", &T::facing,
           unless_default(in_range({0.0, std::numbers::pi}, "rad",
                                   "turning that plans of a differential base prefer to a drive backwards, where no "
                                   "camera looks behind the base; 0: the shorter turn decides")));
  v.member("least", &T::least,
           unless_default(in_range({0.0, 1.0}, "m",
                                   "edge of the smallest cube of unseen space that counts: smaller things "
                                   "are taken to be seen from somewhere; 0: each cell counts")));
  v.member("behind", &T::behind,
           unless_default(in_range({0.0, 1.0}, "m",
                                   "depth behind the ends of rays up to which smaller pockets count, too: what was "
                                   "seen from one side alone is that deep")));
  v.member("boxes", &T::boxes, in_range({1.0, 1000.0}, "", "number of boxes, the nearest ones"));
}

/// Map of the space around the robot from its sensors' ranges (map/seen_map.h).
struct MapParams {
  /// Number of objects that stand for the map.
  constexpr int num_objects() const noexcept { return boxes + (unseen.enabled ? unseen.boxes : 0); }

  bool enabled = false;
  double cell = 0.05;   ///< edge of a cell [m]
  double window = 6.4;  ///< horizontal edge of the mapped window, which moves with the base [m]
  double height = 2.0;  ///< of the window, above the floor [m]
  double floor = 0.04;  ///< lower points are the floor's [m]
  double own = 0.05;    ///< points this near to the robot's shapes are its own [m]
  int rays = 5000;      ///< per control step; a frame that has begun ends
  double reach = 2.5;   ///< horizontal distance from the base up to which occupied space counts [m]
  int boxes = 256;      ///< most boxes of occupied space
  double often = 0.3, merge = 1.0;
  EvidenceParams evidence;
  UnseenParams unseen;
};

constexpr void describe(auto& v, Of<MapParams>) {
  using T = MapParams;
  v.member("cell", &T::cell, in_range({0.01, 1.0}, "m", "edge of a cell"));
  v.member("window", &T::window, in_range({1.0, 30.0}, "m", "horizontal edge of the mapped window about the base"));
  v.member("height", &T::height, in_range({0.1, 10.0}, "m", "height of the mapped window above the floor"));
  v.member("floor", &T::floor, non_negative("m", "height below which points are the floor's"));
  v.member("own", &T::own, non_negative("m", "distance from the robot's shapes up to which points are its own"));
  v.member("rays", &T::rays,
           in_range({1.0, 1e6}, "", "rays that a control step takes; a frame that has begun is taken to its end"));
  v.member("reach", &T::reach, positive("m", "horizontal distance from the base up to which occupied space counts"));
  v.member("boxes", &T::boxes, in_range({1.0, 5000.0}, "", "number of boxes of occupied space, the nearest ones"));
  v.member("often", &T::often,
           unless_default(non_negative("s", "time after which boxes are looked at, unless they miss a new cell")));
  v.member("merge", &T::merge, unless_default(non_negative("s", "time after which all boxes are made anew")));
  v.member("evidence", &T::evidence, unless_default({.text = "log-odds of hits and passing rays"}));
  v.optional("unseen", &T::unseen, &UnseenParams::enabled, Off::kOmitted,
             "the robot stops in front of space that no sensor has seen");
}

}  // namespace moma
