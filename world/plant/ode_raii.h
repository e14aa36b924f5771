#pragma once

#include <ode/ode.h>

#include <memory>
#include <stdexcept>
#include <type_traits>

#include "controller/types.h"
#include "world/plant/ode_runtime.h"

namespace moma::ode {

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

inline void to_matrix(const Matrix3& R, dMatrix3 out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[4 * i + j] = R(i, j);
    out[4 * i + 3] = 0.0;
  }
}

inline Matrix3 from_matrix(const dReal* R) {
  Matrix3 out;
  out << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return out;
}

inline Vector3 from_vector(const dReal* v) { return {v[0], v[1], v[2]}; }

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

inline Isometry pose(const dReal* R, const dReal* p) {
  Isometry X = Isometry::Identity();
  X.linear() = from_matrix(R);
  X.translation() = from_vector(p);
  return X;
}
inline Isometry pose(dBodyID body) { return pose(dBodyGetRotation(body), dBodyGetPosition(body)); }
inline Isometry pose(dGeomID geom) { return pose(dGeomGetRotation(geom), dGeomGetPosition(geom)); }

}  // namespace moma::ode
