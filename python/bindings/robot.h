#pragma once

#include <string>
#include <utility>

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

  // Each gives a row for each configuration.
  Matrix fk(const Rows& base, const Rows& q, const std::string& link) const;     ///< 4 x 4; of E without a name
  Matrix jacobian(const Rows& base, const Rows& q) const;                        ///< 6 x velocities
  VectorX manipulability(const Rows& q, const std::string& rows) const;          ///< one number
  Matrix manipulability_gradient(const Rows& q, const std::string& rows) const;  ///< joints
  std::pair<Matrix, Matrix> integrate(const Rows& base, const Rows& q, const Rows& velocity, double seconds) const;
  /// To the nearest object; infinite without objects.
  VectorX clearance(const Rows& base, const Rows& q, const std::string& objects) const;
  /// `objects`: a JSON list of objects as in a case file. A list of (kind, first, second, d, n_W, p_first_W,
  /// p_second_W).
  nb::list distances(const Vector3& base, const VectorX& q, const std::string& objects,
                     const ProximityRanges& ranges) const;

 private:
  template <class Body>
  void each(const Rows& base, const Rows& q, Body body) const;

  config::LoadedRobot loaded_;
};

}  // namespace moma::python
