#pragma once

// Speeds and accelerations of a path, by differences.

#include <gtest/gtest.h>

#include "controller/plan/path.h"

namespace moma::test {

/// Largest speeds and accelerations of a path, by differences.
struct Extremes {
  WholeConfiguration speed, acceleration;
};

inline Extremes extremes(const Path& path) {
  const double h = 0.001;
  Extremes most{WholeConfiguration::Zero(path.origin.size()), WholeConfiguration::Zero(path.origin.size())};
  WholeConfiguration before, now, after;
  for (double t = 0.0; t < path.duration + h; t += h) {
    path.at(t - h, before);
    path.at(t, now);
    path.at(t + h, after);
    most.speed = most.speed.cwiseMax((after - before).cwiseAbs() / (2.0 * h));
    most.acceleration = most.acceleration.cwiseMax((after - 2.0 * now + before).cwiseAbs() / (h * h));
  }
  return most;
}

inline constexpr double kDifferences = 1.0 + 1e-4;  // a limit, with the error of differences

// Joints and the base's turn.
inline void expect_within(const MotionLimits& limits, const Extremes& most, std::uint64_t seed) {
  for (int i = 0; i < limits.num_joints(); ++i) {
    EXPECT_LE(most.speed[3 + i], kDifferences * limits.joint_speed[i]) << "joint " << i << ", seed " << seed;
    EXPECT_LE(most.acceleration[3 + i], kDifferences * limits.joint_acceleration[i])
        << "joint " << i << ", seed " << seed;
  }
  if (!limits.mobile()) return;
  EXPECT_LE(most.speed[2], kDifferences * limits.angular) << "seed " << seed;
  EXPECT_LE(most.acceleration[2], kDifferences * limits.angular_acceleration) << "seed " << seed;
}

}  // namespace moma::test
