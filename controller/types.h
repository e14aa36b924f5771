#pragma once

#include <Eigen/Dense>

// With AVX or a sanitizer Eigen would align its types and memory differently from the library: structs would have
// another layout, and one side could not free the other's memory. The CMake targets define both.
static_assert(
    EIGEN_MAX_STATIC_ALIGN_BYTES <= 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
    "define EIGEN_MAX_ALIGN_BYTES=16 and EIGEN_MALLOC_ALREADY_ALIGNED=1 wherever moma's headers are included, "
    "as its library is built, or link the CMake target moma::controller, which does");

namespace moma {

// Conventions (docs/reference/conventions.md): metres, radians, seconds; world W has z up, base B has x forward,
// end effector E is the tip link plus tool offset. Six-vectors are [angular; linear] in world axes with
// the linear velocity taken at the point that the name says. Quaternions are written w x y z.

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using VectorX = Eigen::VectorXd;
using Matrix3 = Eigen::Matrix3d;
using Matrix3X = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using MatrixX = Eigen::MatrixXd;
using Isometry = Eigen::Isometry3d;

/// The pose with rotation R at p.
inline Isometry pose_of(const Matrix3& R, const Vector3& p) noexcept {
  Isometry X(R);
  X.translation() = p;
  return X;
}

}  // namespace moma
