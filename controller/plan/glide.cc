#include "controller/plan/glide.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr double kLeastRise = 0.04;  // [s]
constexpr double kNoMotion = 1e-9;

// One coordinate, or the base's place.
struct Axis {
  Eigen::Index first, size;
  double speed, acceleration;
};

template <class Visit>
void for_each_axis(const MotionLimits& limits, Moves moves, const Visit& visit) noexcept {
  if (moves == Moves::kBase) {
    visit(Axis{0, 2, limits.linear, limits.linear_acceleration});
    visit(Axis{2, 1, limits.angular, limits.angular_acceleration});
  } else {
    for (Eigen::Index i = 0; i < limits.num_joints(); ++i)
      visit(Axis{3 + i, 1, limits.joint_speed[i], limits.joint_acceleration[i]});
  }
}

Trapezoid glide_with(const MotionLimits& limits, Moves moves, const MotionState& start, const WholeConfiguration& end,
                     double rise) noexcept {
  double least = 0.0, square = 0.0;
  for_each_axis(limits, moves, [&](const Axis& axis) {
    const auto v = start.v.segment(axis.first, axis.size);
    double xx = 0.0, xv = 0.0;
    for (Eigen::Index i = 0; i < axis.size; ++i) {
      const double x = end[axis.first + i] - start.c[axis.first + i] - 0.5 * rise * v[i];
      xx += x * x;
      xv += x * v[i];
    }
    const double way = std::sqrt(xx);
    if (way < kNoMotion) return;
    least = std::max(least, way / axis.speed);
    if (!std::isfinite(axis.acceleration)) return;
    square = std::max(square, way / axis.acceleration);
    const double change = axis.acceleration * rise;
    const double most = xv + std::sqrt(std::max(0.0, xv * xv + xx * (change * change - v.squaredNorm())));
    least = std::max(least, most > 0.0 ? xx / most : kInfinity);
  });
  if (least == 0.0) return {rise, rise, 0.0};
  const double fall = std::min(square / least, std::sqrt(2.0 * square));
  const double full = std::max(least, 0.5 * (rise + fall));
  return {0.5 * (rise + fall) + (fall > 0.0 ? std::max(full, square / fall) : full), rise, fall};
}

bool glides(const MotionLimits& limits, Moves moves, const MotionState& a, const MotionState& b,
            const Trapezoid& glide) noexcept {
  bool holds = true;
  for_each_axis(limits, moves, [&](const Axis& axis) {
    double full = 0.0, rising = 0.0, falling = 0.0;
    for (Eigen::Index i = axis.first; i < axis.first + axis.size; ++i) {
      const double x = b.c[i] - a.c[i] - 0.5 * (glide.rise * a.v[i] + glide.fall * b.v[i]);
      const double w = x / (glide.time - 0.5 * (glide.rise + glide.fall));
      full += w * w;
      rising += (w - a.v[i]) * (w - a.v[i]);
      falling += (w - b.v[i]) * (w - b.v[i]);
    }
    const auto within = [](double square, double most) { return square <= most * most; };
    holds = holds && within(full, axis.speed) && within(rising, axis.acceleration * glide.rise) &&
            within(falling, axis.acceleration * glide.fall);
  });
  return holds;
}

}  // namespace

Trapezoid glide_to_rest(const MotionLimits& limits, Moves moves, const MotionState& start,
                        const WholeConfiguration& end) noexcept {
  double shortest = kLeastRise, square = 0.0, at_speed = 0.0;
  for_each_axis(limits, moves, [&](const Axis& axis) {
    shortest = std::max(shortest, start.v.segment(axis.first, axis.size).norm() / axis.acceleration);
    const double way = (end - start.c).segment(axis.first, axis.size).norm();
    at_speed = std::max(at_speed, way / axis.speed);
    square = std::max(square, way / axis.acceleration);
  });
  Trapezoid best{.time = kInfinity};
  const auto consider = [&](double rise) {
    const Trapezoid glide = glide_with(limits, moves, start, end, rise);
    if (glide.time < best.time) best = glide;
  };
  for (const double longer : {1.0, 1.25, 1.6, 2.2, 3.0}) consider(longer * shortest);
  const double from_rest = quickest(at_speed, square).rise;
  if (from_rest > shortest) consider(from_rest);
  return best;
}

Trapezoid quick_glide(const MotionLimits& limits, Moves moves, const MotionState& a, const MotionState& b,
                      double least) noexcept {
  constexpr double kLonger = 1.03, kLongest = 20.0;  // [1, s]
  double time = std::max(least, 2.0 * kLeastRise);
  for_each_axis(limits, moves, [&](const Axis& axis) {
    time = std::max(time, (b.c - a.c).segment(axis.first, axis.size).norm() / axis.speed);
  });
  for (; time < kLongest; time *= kLonger)
    for (const double rise : {0.2, 0.1, 0.35, 0.5})
      for (const double fall : {0.2, 0.1, 0.35, 0.5})
        if (const Trapezoid glide{time, rise * time, fall * time}; glides(limits, moves, a, b, glide)) return glide;
  return {.time = kInfinity};
}

void add_glide(Moves moves, const Trapezoid& glide, const MotionState& a, const MotionState& b, Path& path) noexcept {
  const Eigen::Index first = moves == Moves::kBase ? 0 : 3;
  const Eigen::Index size = moves == Moves::kBase ? 3 : a.c.size() - 3;
  const auto add = [&](double start, const Trapezoid& motion, const WholeConfiguration& change) {
    PathPart part{start, motion, WholeConfiguration::Zero(a.c.size())};
    part.change.segment(first, size) = change.segment(first, size);
    path.add(part);
  };
  const WholeConfiguration before = 0.5 * glide.rise * a.v, after = 0.5 * glide.fall * b.v;
  if (a.moves()) add(0.0, {glide.rise, 0.0, glide.rise}, before);
  add(0.0, {glide.time, glide.rise, glide.fall}, b.c - a.c - before - after);
  if (b.moves()) add(glide.time - glide.fall, {glide.fall, glide.fall, 0.0}, after);
  path.duration = std::max(path.duration, glide.time);
}

}  // namespace moma
