#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "controller/model/floor_reach.h"
#include "controller/model/proximity.h"
#include "world/draws.h"
#include "world/scenario/distribution.h"
#include "world/world.h"

namespace moma {

/// Places of start and witness: the keys that all families share. The robot starts at the origin, arm at `ready`.
/// A fixed base stays there; `distance`, `direction` and the headings are for mobile ones.
struct Placement {
  using Uniform = Distribution::Uniform;
  Distribution start_heading{Uniform{-std::numbers::pi, std::numbers::pi}};  ///< [rad]
  Distribution distance{Uniform{0.5, 4.0}};                                  ///< [m]
  Distribution direction{Uniform{-std::numbers::pi, std::numbers::pi}};      ///< [rad]
  Distribution heading{Uniform{-std::numbers::pi, std::numbers::pi}};        ///< [rad]
  double limit_margin = 0.1;      ///< [rad or m]; a quarter of the joint's range at most
  double tip_height = 0.1;        ///< [m]
  double floor_clearance = 0.02;  ///< [m]
  double self_clearance = 0.01;   ///< [m]
};

constexpr void describe(auto& v, Of<Placement>) {
  using T = Placement;
  v.member("start_heading", &T::start_heading, quantity("rad", "of the base at the start"));
  v.member("distance", &T::distance, non_negative("m", "from the start to the witness's base"));
  v.member("direction", &T::direction, quantity("rad", "of that line in the world"));
  v.member("heading", &T::heading, quantity("rad", "of the witness's base"));
  v.member(
      "limit_margin", &T::limit_margin,
      non_negative("rad or m", "the witness's joints keep so far from their limits, a quarter of their range at most"));
  v.member("tip_height", &T::tip_height, quantity("m", "least height of the goal"));
  v.member("floor_clearance", &T::floor_clearance, non_negative("m", "of the witness's moving shapes over the floor"));
  v.member("self_clearance", &T::self_clearance, non_negative("m", "between the witness's own shapes"));
}

/// Distances of objects from the robot at start and witness.
struct Room {
  double clearance = 0.0;  ///< to start and witness [m]
  double start = 0.0;      ///< to the start, at t = 0 [m]
};

/// Makes one world in tries. Every failed check is counted by name, so that an error can name the limiting constraint.
/// Owns the workspace; one per world.
class SceneBuilder {
 public:
  static constexpr double kTimeStep = 1e-3;  ///< [s]
  /// Number of consecutive first objects without a place after which the search ends.
  static constexpr int kMostNowhere = 40000;

  SceneBuilder(std::shared_ptr<const RobotModel> model, std::uint64_t seed, std::uint64_t index, const Room& room,
               std::shared_ptr<const Moves> moves = nullptr);

  const RobotModel& model() const { return *model_; }
  const std::shared_ptr<const RobotModel>& model_pointer() const { return model_; }
  double clearance() const { return room_.clearance; }
  bool mobile() const { return model_->mobile(); }

  /// Returns the draws of this try for one purpose. `item` numbers the placed objects.
  Draws draws(Stream stream, std::uint64_t item = 0) const {
    return {seed_, index_, stream, attempt_, item, moves_.get()};
  }
  void begin(std::uint64_t attempt, World& world);
  /// Counts a failed check; returns false for `return reject(...)`.
  bool reject(const std::string& constraint);
  /// Counts an object that is drawn again within a try.
  void drawn_again(const std::string& why) { ++redraws_[why]; }
  /// Records whether one of `draws` draws of a try's first object found a place.
  void first_object(bool placed, int draws) { nowhere_ = placed ? 0 : nowhere_ + draws; }
  /// True if so many consecutive first objects over all tries found no place that none will.
  bool hopeless() const { return nowhere_ >= kMostNowhere; }
  const std::map<std::string, std::uint64_t>& rejections() const { return rejections_; }
  const std::map<std::string, std::uint64_t>& redraws() const { return redraws_; }
  /// Returns the constraint that failed most often with its count; ties by name.
  std::string worst_constraint() const;

  /// Draws start, witness and goal, and checks them against floor and self-collision.
  bool place_robot(const Placement& placement, World& world);
  /// Draws a further goal after the last one, from a witness of its own, which objects keep off as well: `distance`,
  /// `direction` and `heading` are those from the last witness's base.
  /// With `upright` the axis is vertical there, to within 1 mrad.
  bool place_further(const Placement& placement, World& world, const Upright* upright = nullptr);
  /// Moves the arm of `from` until E is at X_WG, within the joint ranges of place_robot(). Objects keep off the result
  /// as well, which further() returns. Rejects the try if the arm cannot, or touches the floor or itself.
  bool move_arm(const Placement& placement, const Kinematics& from, const Isometry& X_WG);
  /// The witness of the last further goal.
  const Kinematics& further() const { return further_.back(); }
  const Kinematics& witness() const { return witness_; }
  /// Does as place_robot() with a drawn arm at the start as well: each joint of start and witness is uniform in the
  /// middle `range` [0, 1] of its limits. Ignores `placement.limit_margin`; both configurations keep off floor and
  /// self.
  bool place_pair(const Placement& placement, double range, World& world);
  /// Does as place_robot(), with a world that asks for an upright tool: its axis is vertical at the start, and tilts by
  /// at most `angle` [rad]. The witness's arm is drawn, and brought to a tilt of at most a share of that, `at_goal`.
  bool place_upright(const Placement& placement, double angle, const Distribution& at_goal, World& world);
  /// Keeps start and witness of the world, unchecked, and sets the goal to the witness's tool pose.
  void take_robot(World& world);
  /// Sets the goal to the witness's tool pose.
  void set_goal(World& world);

  /// Checks that a configuration keeps off the floor and itself as the witness must; rejects the try otherwise.
  bool check_configuration(const Configuration& configuration, const Placement& placement);
  /// Unit vector of the witness's reach: from the last link whose origin is at least `apart` [m] away to the tool
  /// point.
  Vector3 approach(double apart = 0.1) const;

  /// Tool position at the start, after place_robot().
  const Vector3& start_tip() const { return start_tip_; }
  /// True if the object is farther than `clearance` from start and witness, and farther than Room::start from the
  /// start, at t = 0.
  bool stands_clear(const WorldObject& object, double clearance);
  /// True if the object is farther than `clearance` from start and witness at every t in [0, horizon], by conservative
  /// advancement with the object's own top speed (a bound on the speed of its points). Times are at least kTimeStep
  /// apart, so that the object may come nearer by top_speed * kTimeStep. At t = 0 it must also be farther than
  /// Room::start from the start.
  bool clear_for(const WorldObject& object, double top_speed, double horizon, double clearance);

  /// Moves an object at rest along a unit vector, `furthest` at most, until its distance to the witness is `clearance`,
  /// to within 0.1 mm above. False if it is nearer where it begins, or passes the robot.
  bool bring_near(WorldObject& object, const Vector3& direction_W, double furthest, double clearance);
  /// The same as stands_clear() for the start; the object keeps `at_witness` from the witnesses.
  bool stands_near(const WorldObject& object, double at_witness);

  /// Circles on the floor, (x, y, radius), that contain the projections of start and witness. After place_robot().
  std::vector<Vector3> footprints() const;

  void measure(World& world);
  /// Pairs that are in touch at the start, "link - link" or "link - object", after take_robot().
  std::vector<std::string> touching_at_start(const World& world);

 private:
  Draws place_bases(const Placement& placement, World& world) const;
  /// Least and greatest values of the witness's joints.
  std::pair<VectorX, VectorX> arm_range(const Placement& placement) const;
  void draw_arm(const Placement& placement, Draws& from, VectorX& q) const;
  void place_start(const World& world);
  bool check_start();
  bool place_goal(const Placement& placement, World& world);
  bool check_pose(const Kinematics& kinematics, double floor_clearance, double self_clearance, const std::string& who,
                  bool at_ready = false);
  void choose_object(const WorldObject& object);
  /// Chooses all objects of the world and returns their states at t = 0.
  std::vector<ObjectState> choose_objects(const World& world);
  /// Least distance of the chosen objects in these states, at most `range`.
  double distance(const Kinematics& at, const std::vector<ObjectState>& states, double range);
  /// The same to the witnesses of all goals.
  double distance_to_witnesses(const std::vector<ObjectState>& states, double range);
  /// True if the chosen object is outside Room::start at t = 0.
  bool leaves_start_room(const WorldObject& object);
  /// Least distance of the chosen object to start and witnesses at time t of its motion, at most `range`.
  double distance_at(const WorldObject& object, double t, double range);

  std::shared_ptr<const RobotModel> model_;
  std::uint64_t seed_, index_, attempt_ = 0;
  std::shared_ptr<const Moves> moves_;
  Room room_;
  Kinematics start_, witness_;
  std::vector<Kinematics> further_;  ///< witnesses of further goals
  Proximity proximity_;              ///< one for self pairs and objects: geometry of meshes takes long to build
  FloorReach reach_;
  std::vector<ObjectState> one_;
  Vector3 start_tip_ = Vector3::Zero();
  bool start_checked_ = false;
  int nowhere_ = 0;  // draws of first objects since one of them found a place
  std::map<std::string, std::uint64_t> rejections_;
  std::map<std::string, std::uint64_t> redraws_;
};

}  // namespace moma
