#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// Motion of a sensor to and fro about the z axis of its link: reach sin(2 pi t / period).
struct Pan {
  double reach = 0.0;   ///< to either side [rad]; 0: the sensor is fixed
  double period = 3.0;  ///< [s]

  double angle(double time) const noexcept { return reach * std::sin(2.0 * std::numbers::pi * time / period); }
};

constexpr void describe(auto& v, Of<Pan>) {
  v.member("reach", &Pan::reach,
           in_range({0.0, std::numbers::pi}, "rad", "turn to either side about the z axis of the link; 0: fixed"));
  v.member("period", &Pan::period, in_range({0.1, 100.0}, "s", "time of one turn to and fro"));
}

/// A depth camera or a scanner of the robot: a grid of rays from the origin of its frame C, evenly spaced in azimuth
/// about z_C and in elevation above the plane of x_C and y_C. The middle of the grid points along x_C. A planar scanner
/// has one row. `position` and `rpy` place C in the link's frame, as URDF does.
struct Sensor {
  std::string name;
  std::string link;  ///< "": the base
  Vector3 position = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  std::array<double, 2> field_of_view{0.5 * std::numbers::pi, 0.375 * std::numbers::pi};  ///< full angles [rad]
  int columns = 80;
  int rows = 60;
  double range = 3.0;  ///< [m]
  double rate = 10.0;  ///< frames in a second [1/s]
  Pan pan;
};

/// Bounds time and memory of a frame.
inline constexpr int kMaxRays = 100'000;

constexpr void describe(auto& v, Of<Sensor>) {
  using S = Sensor;
  v.member("name", &S::name, {.required = true, .text = "unique name of the sensor"});
  v.member("link", &S::link, {.text = "link that carries the sensor; default the base"});
  v.member("position", &S::position, in_range({-100.0, 100.0}, "m", "position in the link's frame"));
  v.member("rpy", &S::rpy, in_range({-10.0, 10.0}, "rad", "orientation: the sensor looks along its x axis, z is up"));
  v.member("field_of_view", &S::field_of_view,
           in_range({0.0, 2.0 * std::numbers::pi}, "rad",
                    "full angles: azimuth, and elevation (at most pi); [4.7, 0] of a planar scanner"));
  v.member("columns", &S::columns, in_range({1.0, 10'000.0}, "", "number of rays along the azimuth"));
  v.member("rows", &S::rows,
           in_range({1.0, 10'000.0}, "", "number of rays along the elevation; 1 for a planar scanner"));
  v.member("range", &S::range, positive("m", "range of each ray"));
  v.member("rate", &S::rate, in_range({0.1, 10'000.0}, "1/s", "frames per second"));
  v.member("pan", &S::pan, unless_default({.text = "motion to and fro about the z axis of the link"}));
}

}  // namespace moma
