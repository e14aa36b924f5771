#pragma once

#include <string>
#include <vector>

#include "controller/config/robot_file.h"
#include "controller/model/proximity.h"
#include "python/bindings/bindings.h"

namespace moma::python {

/// A robot as Python holds it. Configurations come as (N, 3) of the base and (N, joints) of the arm.
class Robot {
 public:
  explicit Robot(config::LoadedRobot loaded) : loaded_(std::move(loaded)) {}

  const config::LoadedRobot& loaded() const noexcept { return loaded_; }
  const RobotModel& model() const noexcept { return *loaded_.model; }

  Array fk(const Rows& base, const Rows& q, const std::string& link) const;     ///< (N, 4, 4); of E without a name
  Array jacobian(const Rows& base, const Rows& q) const;                        ///< (N, 6, velocities)
  Array manipulability(const Rows& q, const std::string& rows) const;           ///< (N,)
  Array manipulability_gradient(const Rows& q, const std::string& rows) const;  ///< (N, joints)
  nb::tuple integrate(const Rows& base, const Rows& q, const Rows& velocity, double seconds) const;  ///< base, q
  /// (N,), to the nearest object; infinite without objects.
  Array clearance(const Rows& base, const Rows& q, const std::string& objects) const;
  /// `objects`: a JSON list of objects as in a case file. A list of (kind, first, second, d, n_W, p_first_W,
  /// p_second_W).
  nb::list distances(const Values& base, const Values& q, const std::string& objects, double object_range,
                     double floor_range, double self_range) const;

 private:
  template <class Body>
  void each(const Rows& base, const Rows& q, Body body) const;
  template <class Body>
  void each(const Rows& q, Body body) const;

  config::LoadedRobot loaded_;
};

}  // namespace moma::python
