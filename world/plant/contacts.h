#pragma once

#include <ode/ode.h>

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "controller/model/convex_distance.h"
#include "world/plant/exact_contacts.h"
#include "world/plant/gap_watch.h"
#include "world/plant/ode_library.h"
#include "world/plant/plant.h"

namespace moma {

class ContactScene;

/// Compares ODE with the distance library (coal) on every pair that ODE decides, in the poses of ODE's own geoms, and
/// counts contradictions. The lowest point of a shape decides about the floor.
class CrossCheck {
 public:
  /// Smallest contradiction that counts [m]; coal's distances have errors up to 2e-6 m.
  static constexpr double kTolerance = 1e-5;

  CrossCheck(const RobotModel& model, const World& world);

  /// Compares the detectors in the scene's present state, without changing it.
  DetectorCheck compare(ContactScene& scene);

 private:
  static void judge(bool touches, double distance, DetectorCheck& check);
  void compare_pair(const Solid& a, dGeomID geom_a, const Solid& b, dGeomID geom_b, bool touches, DetectorCheck& check);

  std::vector<Solid> shapes_, objects_;
  ConvexDistance coal_;
};

/// Two solids in contact, with ODE's contact points; normals point into the robot shape `first`.
struct Touch {
  PairKind kind;
  int first;
  int second;  ///< as in Contact
  const dContactGeom* points;
  int count;
};

using TouchSink = std::function<void(const Touch&)>;

/// Collects the contacts of one advance(): each pair once, with its first time and greatest depth.
class ContactLog {
 public:
  explicit ContactLog(std::vector<Contact>& contacts) : contacts_(contacts) {}
  void add(const Contact& contact);
  /// Adds a contact that ODE decides, with the depth of its deepest point.
  void add(const Touch& touch, double time);
  void sort();

 private:
  std::vector<Contact>& contacts_;
};

/// The solids of robot, objects and floor as ODE geoms in two simple spaces, for both plants. Each box is turned by a
/// different angle of about 1e-9 rad, because ODE misses box pairs at exactly 90 degrees.
class ContactScene {
 public:
  static constexpr int kPointsPerPair = 4;

  /// @param base_meets_floor whether shapes rigid with the base are checked against the floor if they are clear of it
  /// with the base upright. In kinematic mode they cannot come nearer.
  ContactScene(std::shared_ptr<const RobotModel> model, const World& world, bool base_meets_floor);

  /// Null if the distance library decides contacts of this shape.
  dGeomID robot_geom(int shape) const { return robot_geoms_[static_cast<std::size_t>(shape)]; }
  dGeomID object_geom(int object) const { return object_geoms_[static_cast<std::size_t>(object)]; }
  Isometry robot_tilt(int shape) const;
  const std::vector<ObjectState>& object_states() const { return states_; }
  bool objects_move() const { return !moving_.empty(); }

  /// Places the robot's geoms that are not attached to bodies.
  void place_robot(const Kinematics& kinematics);
  void set_paces(std::span<const Pace> paces) { paces_.assign(paces.begin(), paces.end()); }
  /// Moves the objects to their poses at time t.
  void place_objects(double t);

  /// Reports every touching pair that ODE decides to `sink`, in a fixed order.
  void detect(const TouchSink& sink);
  const std::vector<SelfPair>& self_pairs() const { return self_pairs_; }
  /// True for a carried object and its support.
  bool rests(PairKind kind, int first, int second) const;
  /// True for each shape that may touch the floor, including shapes that ODE does not decide.
  const std::vector<bool>& meets_floor() const { return meets_floor_; }
  DetectorCheck cross_check();

  /// True if the distance library decides some pairs.
  bool has_exact() const { return exact_ != nullptr; }
  void detect_exact(const Kinematics& kinematics, double time, ContactLog& log);

 private:
  struct Tag {
    PairKind kind;  // kSelf marks a robot shape
    int index;
  };
  static void near(void* data, dGeomID a, dGeomID b);
  void collide(PairKind kind, int first, int second, dGeomID a, dGeomID b, const TouchSink& sink) const;

  std::shared_ptr<const RobotModel> model_;
  World world_;
  ode::Space robot_space_, world_space_;
  std::vector<dGeomID> robot_geoms_, object_geoms_;
  dGeomID floor_ = nullptr;
  std::vector<double> radii_;
  std::vector<bool> meets_floor_;
  std::vector<Tag> tags_;
  std::vector<int> moving_;
  std::vector<SelfPair> self_pairs_;
  std::vector<ObjectState> states_;
  std::vector<Pace> paces_;  // of all objects
  std::unique_ptr<ExactContacts> exact_;
  std::vector<Contact> exact_found_;
  std::unique_ptr<CrossCheck> cross_check_;  // created at first use
};

}  // namespace moma
