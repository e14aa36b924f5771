#pragma once

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// Angles of a head: pan about the z axis of its link, tilt about the y axis that turns with it, positive downwards
/// [rad].
struct Gaze {
  double pan = 0.0;
  double tilt = 0.0;

  bool operator==(const Gaze&) const = default;
};

/// A head: the sensor turns on its link where the controller looks. A range of no width is a fixed angle.
struct Head {
  Vector3 axes = Vector3::Zero();  ///< point of the link in which the axes meet [m]
  std::array<double, 2> pan{};     ///< range of the angle [rad]
  std::array<double, 2> tilt{};    ///< [rad]
  double speed = 2.0;              ///< of each angle, at most [rad/s]

  bool turns() const noexcept { return pan[1] > pan[0] || tilt[1] > tilt[0]; }
  Gaze within(const Gaze& asked) const noexcept {
    return {std::clamp(asked.pan, pan[0], pan[1]), std::clamp(asked.tilt, tilt[0], tilt[1])};
  }
};

constexpr void describe(auto& v, Of<Head>) {
  v.member("axes", &Head::axes, in_range({-100.0, 100.0}, "m", "where the axes meet, in the link's frame"));
  constexpr Range kTurn{-std::numbers::pi, std::numbers::pi};
  v.member("pan", &Head::pan, in_range(kTurn, "rad", "range of the angle about the z axis of the link"));
  v.member("tilt", &Head::tilt,
           in_range(kTurn, "rad", "range of the angle about the turned y axis, positive downwards"));
  v.member("speed", &Head::speed, positive("rad/s", "speed of each angle, at most"));
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
  Head head;
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
  v.member("head", &S::head, unless_default({.text = "the sensor turns on its link, where the controller looks"}));
}

}  // namespace moma
