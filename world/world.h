#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/describe/column.h"
#include "controller/describe/describe.h"
#include "controller/model/proximity.h"
#include "controller/model/upright.h"
#include "world/draws.h"
#include "world/motion.h"

namespace moma {

struct Configuration {
  Vector3 base = Vector3::Zero();  ///< (x, y, phi)
  VectorX q;
};

/// Manners of an object that gives way to the robot, as people do (yielding.h).
struct Yields {
  double distance = 0.0;  ///< of parts of the robot ahead of it that make it wait; 0: it does not give way [m]
  double patience = 3.0;  ///< time that it waits before it turns round [s]
  double side = 0.3;      ///< room beside its way within which parts of the robot count as ahead [m]
};

constexpr void describe(auto& v, Of<Yields>) {
  v.member(
      "distance", &Yields::distance,
      non_negative("m", "parts of the robot that are nearer and ahead of it make it wait; 0: it does not give way"));
  v.member("patience", &Yields::patience, non_negative("s", "time that it waits before it turns round"));
  v.member("side", &Yields::side,
           unless_default(non_negative("m", "room beside it within which parts of the robot count as ahead")));
}

struct WorldObject {
  std::string name;  ///< unique within the world
  Shape shape;
  Isometry X_WO = Isometry::Identity();  ///< at t = 0
  Motion motion;
  Eigen::Quaterniond file_rotation = Eigen::Quaterniond::Identity();  ///< see set_pose()
  int noise = -1;  ///< number of the draws of its sensing errors; -1: its place among the objects
  Yields yields = {};
};

inline bool gives_way(const WorldObject& object) noexcept { return object.yields.distance > 0.0; }

/// The time of an object's own motion: `at` at time `since`, from where on it runs at `rate`.
struct Pace {
  double since = 0.0;  ///< [s]
  double at = 0.0;     ///< [s]
  double rate = 1.0;   ///< 1; 0: the object waits; -1: it goes back

  double time(double t) const noexcept { return std::max(0.0, at + rate * (t - since)); }
};

struct WorldGoal {
  Isometry X_WG = Isometry::Identity();  ///< at t = 0
  Motion motion;
  Eigen::Quaterniond file_rotation = Eigen::Quaterniond::Identity();  ///< see set_pose()
  bool stop = true;                ///< false: it counts as reached as soon as E is within tolerance
  Vector6 free = Vector6::Zero();  ///< 1: a free direction (GoalState)
  std::string take, leave;         ///< name of the object that the hand takes, or leaves, once the goal is reached
};

/// An object that the hand holds from the start, as if it had taken it there.
struct Held {
  std::string object;
  std::vector<std::string> touch;  ///< links that it may touch, beside those that are rigid with E

  bool operator==(const Held&) const = default;
};

struct Difficulty {
  double goal_distance_m = 0.0;  ///< |p_G - p_E(start)|
  int objects = 0;
  double witness_clearance_m = 0.0;  ///< least distance of the witness to any object; NaN without objects
  /// Share of the straight line from start tip to goal within an object (grown by 5 cm).
  double blocked_fraction = 0.0;
  double narrowest_gap_m = 0.0;  ///< least gap between two objects; NaN with fewer than two
};

/// Keys of a world file, columns of the store's table `world`, and metrics of a trial on the report page.
constexpr void describe(auto& v, Of<Difficulty>) {
  using D = Difficulty;
  v.member("goal_distance_m", &D::goal_distance_m,
           Column{.label = "goal distance",
                  .unit = "m",
                  .decimals = 2,
                  .range = Range::non_negative(),
                  .text = "from the start's tip to the goal"});
  v.member("objects", &D::objects,
           Column{.label = "objects", .decimals = 0, .range = {0, 1000000}, .text = "number of objects"});
  v.member("witness_clearance_m", &D::witness_clearance_m,
           Column{.label = "clearance of the witness", .unit = "m", .text = "its least distance to an object"});
  v.member("blocked_fraction", &D::blocked_fraction,
           Column{.label = "blocked part of the straight line",
                  .decimals = 2,
                  .range = {0.0, 1.0},
                  .text = "of the line from start to goal, within an object grown by 5 cm"});
  v.member("narrowest_gap_m", &D::narrowest_gap_m,
           Column{.label = "narrowest gap between objects", .unit = "m", .text = "least gap between two objects"});
}

/// A planning problem as plain numbers: printable, editable by hand, without randomness.
struct World {
  std::uint64_t index = 0;
  std::uint64_t seed = 0;
  std::string family;
  std::string robot;
  Configuration start;
  WorldGoal goal;
  std::vector<WorldGoal> further;  ///< goals after it, one after the other
  std::optional<Upright> upright;  ///< path constraint of the whole trial
  std::optional<Held> held;
  std::vector<WorldObject> objects;
  Configuration witness;  ///< reaches the first goal (at t = 0) clear of all objects
  Difficulty difficulty;
  std::optional<double> time_bound;    ///< of time_bound() [s], where it is known; no part of world files
  std::shared_ptr<const Moves> moves;  ///< moves of the random numbers of its disturbances; null: none
};

/// Sets the pose of an object or the goal. The quaternion is kept beside the pose made from it: a conversion to a
/// matrix and back changes last bits, and a world read from its file must equal the written one.
void set_pose(WorldObject& object, const Vector3& position, const Eigen::Quaterniond& rotation);
void set_pose(WorldGoal& goal, const Vector3& position, const Eigen::Quaterniond& rotation);
template <class T>
void set_pose(T& placed, const Isometry& X_W) {
  set_pose(placed, X_W.translation(), Eigen::Quaterniond(X_W.linear()));
}

std::vector<ObjectShape> object_shapes(const World& world);

/// True pose and twist of an object at time t.
MovingPose place(const WorldObject& object, const Pace& pace, double t);
/// Computes true poses and twists at time t into vectors already sized to world.objects. `paces`: one for each object,
/// or none where no object gives way.
void object_states(const World& world, double t, std::vector<ObjectState>& states, std::span<const Pace> paces = {});
/// Goal number `index`, from 0: world.goal, then world.further.
inline const WorldGoal& goal_of(const World& world, std::size_t index) {
  return index == 0 ? world.goal : world.further[index - 1];
}
/// True if the hand holds an object from the start or takes one at a goal.
bool carries(const World& world);
/// Index of the object with this name; -1 if there is none.
int find_object(const World& world, std::string_view name);
struct GoalState goal_state(const World& world, double t, std::size_t index = 0);

}  // namespace moma
