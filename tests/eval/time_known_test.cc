// For how long an object had been known before it was hit, against what the geometry says.
#include "eval/run/replay.h"

#include <gtest/gtest.h>

#include "controller/config/node.h"
#include "tests/eval/trial_fixture.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

constexpr double kPeriod = 0.02;

/// The base drives along x at 0.5 m/s, past a far ball, into one whose surface is 3 m ahead.
CollisionCase drive(const std::string& disturbances, double seconds = 4.0) {
  World world = test::tiny_world(1.0);
  world.witness = world.start;
  world.objects = {test::sphere("far", {0.0, 50.0, 0.5}, 0.1), test::sphere("hit", {3.1, 0.0, 0.5}, 0.1)};
  CollisionCase collision{to_json(world).dump(), disturbances, "hit", kPeriod, seconds, {}, {}};
  for (int k = 0; k * kPeriod < seconds - 1e-9; ++k) {
    collision.t.push_back(k * kPeriod);
    for (const double value : {0.5 * k * kPeriod, 0.0, 0.0}) collision.base.push_back(value);
  }
  return collision;
}

TEST(TimeKnown, CountsFromRangeDetectionAndDelay) {
  // In range at x = 1, that is at 2 s; found 0.1 s later, known to the controller after another 0.08 s.
  const auto known = known_before_contact(drive("{objects: {range: 2, detection: 0.1, delay: 0.08}}"));
  ASSERT_TRUE(known.has_value());
  EXPECT_NEAR(*known, 4.0 - 2.0 - 0.1 - 0.08, 1.1 * kPeriod);
}

TEST(TimeKnown, WhatIsNeverSeenWasNotKnown) {
  EXPECT_EQ(known_before_contact(drive("{objects: {range: 2, detection: 3}}")), 0.0);
  EXPECT_EQ(known_before_contact(drive("{objects: {range: 2, delay: 1.9}}", 3.0)), 0.0) << "known after the contact";
}

TEST(TimeKnown, WhatIsKnownAtTheStartWasKnownAllTheTime) {
  EXPECT_EQ(known_before_contact(drive("{objects: {range: 5, delay: 0.08, known_at_start: true}}")), 4.0);
}

TEST(TimeKnown, HasNoAnswerWhereEverythingIsSeenOrTheObjectIsNone) {
  EXPECT_FALSE(known_before_contact(drive("{joints: {noise: 0.1}}")).has_value());
  CollisionCase floor = drive("{objects: {range: 2}}");
  floor.object = "floor";
  EXPECT_FALSE(known_before_contact(floor).has_value());
}

TEST(TimeKnown, AWorldNestedWithoutEndIsAnError) {
  CollisionCase deep = drive("{objects: {range: 2}}");
  deep.world = std::string(200000, '[') + std::string(200000, ']');
  try {
    (void)known_before_contact(deep);
    FAIL() << "it was read";
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("nested more than 64 levels"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace moma::run
