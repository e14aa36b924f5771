#pragma once

#include <ode/ode.h>

#include <memory>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "controller/types.h"

namespace moma::ode {

/// An internal error of ODE. Its world must be abandoned, not destroyed; other worlds are not affected.
class Fault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Call before any use of ODE in a thread; cheap when repeated. Starts the library once per process and installs
/// handlers: messages are counted instead of printed, and internal errors throw Fault instead of ending the process.
void use_on_this_thread();

/// Messages of the LCP solver on this thread since the last call.
int take_lcp_messages() noexcept;

struct SpaceDeleter {
  void operator()(dSpaceID space) const { dSpaceDestroy(space); }
};
struct JointGroupDeleter {
  void operator()(dJointGroupID group) const { dJointGroupDestroy(group); }
};
/// Also destroys the geoms that it owns.
using Space = std::unique_ptr<std::remove_pointer_t<dSpaceID>, SpaceDeleter>;
using JointGroup = std::unique_ptr<std::remove_pointer_t<dJointGroupID>, JointGroupDeleter>;

inline Space make_simple_space() {
  Space space(dSimpleSpaceCreate(nullptr));
  dSpaceSetCleanup(space.get(), 1);
  return space;
}

/// A world with its own threading object: worlds stepped in concurrent threads abort on the shared default one.
class World {
 public:
  World() {
    use_on_this_thread();
    id_ = dWorldCreate();
    threading_ = dThreadingAllocateSelfThreadedImplementation();
    if (id_ == nullptr || threading_ == nullptr) throw std::runtime_error("ODE cannot create a world");
    dWorldSetStepThreadingImplementation(id_, dThreadingImplementationGetFunctions(threading_), threading_);
  }
  ~World() {
    if (abandoned_) return;
    dWorldDestroy(id_);
    dThreadingFreeImplementation(threading_);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  dWorldID id() const { return id_; }
  /// After a Fault: leaks the world, whose state is unknown.
  void abandon() { abandoned_ = true; }
  bool abandoned() const { return abandoned_; }

 private:
  dWorldID id_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  bool abandoned_ = false;
};

/// A rotation as ODE has it, with a column of zeros.
using Rows = Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>;

inline void to_matrix(const Matrix3& R, dMatrix3 out) { Eigen::Map<Rows>(out) << R, Vector3::Zero(); }
inline Matrix3 from_matrix(const dReal* R) { return Eigen::Map<const Rows>(R).leftCols<3>(); }
inline Vector3 from_vector(const dReal* v) { return Eigen::Map<const Vector3>(v); }

inline void set_pose(dGeomID geom, const Isometry& X) {
  dMatrix3 R;
  to_matrix(X.linear(), R);
  dGeomSetRotation(geom, R);
  dGeomSetPosition(geom, X.translation().x(), X.translation().y(), X.translation().z());
}

inline void set_offset(dGeomID geom, const Isometry& X) {
  dMatrix3 R;
  to_matrix(X.linear(), R);
  dGeomSetOffsetRotation(geom, R);
  dGeomSetOffsetPosition(geom, X.translation().x(), X.translation().y(), X.translation().z());
}

inline void set_pose(dBodyID body, const Isometry& X) {
  dMatrix3 R;
  to_matrix(X.linear(), R);
  dBodySetRotation(body, R);
  dBodySetPosition(body, X.translation().x(), X.translation().y(), X.translation().z());
}

inline Isometry pose(const dReal* R, const dReal* p) { return pose_of(from_matrix(R), from_vector(p)); }
inline Isometry pose(dBodyID body) { return pose(dBodyGetRotation(body), dBodyGetPosition(body)); }
inline Isometry pose(dGeomID geom) { return pose(dGeomGetRotation(geom), dGeomGetPosition(geom)); }

/// Saves poses and velocities of bodies, so that a step of their world can be undone and repeated: from the same joints
/// it then gives the same bits. Everything else that ODE keeps between steps follows from these or is set before each
/// step; dWorldStep draws no random numbers and has no warm start.
class BodyStates {
 public:
  void add(dBodyID body);
  void save();
  /// Restores the saved states of the bodies and their geoms.
  void restore() const;
  /// False if a present position or velocity is not finite, or a speed beyond `limit` [m/s].
  bool healthy(double limit) const;

 private:
  struct State {
    dBodyID body;
    dReal position[3], quaternion[4], rotation[12], linear[3], angular[3];
  };
  std::vector<State> states_;
};

}  // namespace moma::ode
