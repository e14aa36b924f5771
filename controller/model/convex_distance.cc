// This file drives GJK and EPA itself instead of coal's ComputeDistance, for two reasons in coal 3.0.3: its wheel
// builds an exception object (which allocates) for every assertion that passes, and it keeps hints for the support
// functions of large hulls between calls, which change the last bits. This definition makes the assertions of the
// inline functions below free unless they fail.
#define COAL_TURN_ASSERT_INTO_EXCEPTION

#include "controller/model/convex_distance.h"

#include <coal/narrowphase/gjk.h>
#include <coal/narrowphase/narrowphase_defaults.h>
#include <coal/shape/convex.h>

#include <cmath>
#include <limits>
#include <vector>

namespace moma {

ConvexGeometry convex_geometry(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return std::make_shared<coal::Sphere>(shape.size.x());
    case ShapeKind::kBox:
      return std::make_shared<coal::Box>(shape.size);
    case ShapeKind::kCylinder:
      return std::make_shared<coal::Cylinder>(shape.size.x(), shape.size.y());
    case ShapeKind::kCapsule:
      return std::make_shared<coal::Capsule>(shape.size.x(), shape.size.y());
    case ShapeKind::kConvex:
      break;
  }
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  if (shape.hull) {
    points->assign(shape.hull->vertices.begin(), shape.hull->vertices.end());
    for (const Eigen::Vector3i& t : shape.hull->triangles)
      triangles->emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                              static_cast<std::size_t>(t[2]));
  }
  const auto num_points = static_cast<unsigned>(points->size());
  const auto num_triangles = static_cast<unsigned>(triangles->size());
  return std::make_shared<coal::Convex<coal::Triangle>>(points, num_points, triangles, num_triangles);
}

void resize_box(Solid& solid, const Vector3& size) noexcept {
  solid.shape.size = solid.bound.size = size;
  solid.radius = bounding_radius(solid.shape);
  // The geometry was made by convex_geometry(), as an object that is not constant.
  static_cast<coal::Box&>(const_cast<coal::ShapeBase&>(*solid.geometry)).halfSide = 0.5 * size;
}

namespace {

coal::Transform3s to_coal(const Isometry& X) { return coal::Transform3s(X.linear(), X.translation()); }

// Support point of one solid, in its own frame. coal's support function of boxes depends on more than its arguments:
// coal 3.0.3 grows all boxes of a process by 1e-10 of their size if the first direction of any call contained a zero (a
// local static in getShapeSupport(const Box*)), so that the first query changes every later result. Boxes are therefore
// computed here, exactly.
void support_of(const coal::ShapeBase& shape, const Vector3& direction, Vector3& support, int& hint,
                coal::details::ShapeSupportData& data) {
  using coal::details::getShapeSupport;
  constexpr int kOptions = coal::details::SupportOptions::NoSweptSphere;
  switch (shape.getNodeType()) {
    case coal::GEOM_BOX: {
      const Vector3& half = static_cast<const coal::Box&>(shape).halfSide;
      support = (direction.array() > 0.0).select(half, -half);
      return;
    }
    case coal::GEOM_SPHERE:
      return getShapeSupport<kOptions>(static_cast<const coal::Sphere*>(&shape), direction, support, hint, data);
    case coal::GEOM_CYLINDER:
      return getShapeSupport<kOptions>(static_cast<const coal::Cylinder*>(&shape), direction, support, hint, data);
    case coal::GEOM_CAPSULE:
      return getShapeSupport<kOptions>(static_cast<const coal::Capsule*>(&shape), direction, support, hint, data);
    default: {  // a hull, since convex_geometry() makes nothing else; its two searches are selected as in coal
      // LargeConvex and SmallConvex only select the function, which casts back: no object has these types.
      const auto* const hull = static_cast<const coal::ConvexBase*>(&shape);
      if (hull->num_points > coal::ConvexBase::num_vertices_large_convex_threshold) {
        using coal::details::LargeConvex;
        return getShapeSupport<kOptions>(reinterpret_cast<const LargeConvex*>(hull), direction, support, hint, data);
      }
      using coal::details::SmallConvex;
      return getShapeSupport<kOptions>(reinterpret_cast<const SmallConvex*>(hull), direction, support, hint, data);
    }
  }
}

// Replaces coal's function for pairs with a box.
void support_of_pair(const coal::details::MinkowskiDiff& difference, const Vector3& direction, Vector3& support0,
                     Vector3& support1, coal::support_func_guess_t& hint, coal::details::ShapeSupportData data[2]) {
  support_of(*difference.shapes[0], direction, support0, hint[0], data[0]);
  const Vector3 back = -(difference.oR1.transpose() * direction);
  Vector3 own;
  support_of(*difference.shapes[1], back, own, hint[1], data[1]);
  support1 = difference.oR1 * own + difference.ot1;
}

bool is_box(const coal::ShapeBase& shape) { return shape.getNodeType() == coal::GEOM_BOX; }

// A hundred times below coal's default: within 20 % as quick, and rims are no longer off by up to 0.3 mm.
constexpr double kGjkTolerance = 1e-8;

bool is_good(const Distance& distance) {
  return std::isfinite(distance.d) && std::abs(distance.n_W.norm() - 1.0) < 1e-3 && distance.p_first_W.allFinite() &&
         distance.p_second_W.allFinite();
}

}  // namespace

struct ConvexDistance::Impl {
  coal::details::MinkowskiDiff difference;
  const coal::details::GJK unused{coal::GJK_DEFAULT_MAX_ITERATIONS, kGjkTolerance};
  coal::details::GJK gjk = unused;  // copied for each pair: reset() would allocate
  coal::details::EPA epa{coal::EPA_DEFAULT_MAX_ITERATIONS, coal::EPA_DEFAULT_TOLERANCE};

  // Computes points and normal (from the first to the second solid) in the first solid's frame; false without a result.
  bool run(double& d, Vector3& p1, Vector3& p2, Vector3& normal) {
    gjk = unused;
    gjk.setDistanceEarlyBreak(std::numeric_limits<double>::max());
    gjk.gjk_variant = coal::GJKVariant::DefaultGJK;
    gjk.convergence_criterion = coal::GJKConvergenceCriterion::Default;
    gjk.convergence_criterion_type = coal::GJKConvergenceCriterionType::Relative;
    const Vector3 guess(1.0, 0.0, 0.0);
    gjk.evaluate(difference, guess, coal::support_func_guess_t::Zero());
    switch (gjk.status) {
      case coal::details::GJK::Failed:  // out of iterations: still the best estimate
      case coal::details::GJK::NoCollision:
      case coal::details::GJK::CollisionWithPenetrationInformation:
        d = gjk.distance;
        gjk.getWitnessPointsAndNormal(difference, p1, p2, normal);
        return true;
      case coal::details::GJK::Collision:
        epa.evaluate(gjk, -guess);
        if (epa.status == coal::details::EPA::DidNotRun || epa.status == coal::details::EPA::FallBack) return false;
        d = std::min(0.0, -epa.depth);
        epa.getWitnessPointsAndNormal(difference, p1, p2, normal);
        return true;
      case coal::details::GJK::DidNotRun:
      case coal::details::GJK::NoCollisionEarlyStopped:
        break;
    }
    return false;
  }
};

ConvexDistance::ConvexDistance(int max_vertices) : impl_(std::make_unique<Impl>()) {
  for (auto& data : impl_->difference.data) data.visited.reserve(static_cast<std::size_t>(std::max(0, max_vertices)));
}
ConvexDistance::~ConvexDistance() = default;
ConvexDistance::ConvexDistance(ConvexDistance&&) noexcept = default;
ConvexDistance& ConvexDistance::operator=(ConvexDistance&&) noexcept = default;

Distance ConvexDistance::distance(const ConvexGeometry& first, const Isometry& X_W1, const ConvexGeometry& second,
                                  const Isometry& X_W2) noexcept {
  Distance distance;
  bool good = X_W1.matrix().allFinite() && X_W2.matrix().allFinite();
  if (good) {
    try {
      impl_->difference.set<coal::details::SupportOptions::NoSweptSphere>(first.get(), second.get(), to_coal(X_W1),
                                                                          to_coal(X_W2));
      if (is_box(*first) || is_box(*second)) impl_->difference.getSupportFunc = support_of_pair;
      Vector3 p1, p2, normal;
      good = impl_->run(distance.d, p1, p2, normal);
      if (good) {
        // The points of the solution are less exact than its normal and depth: only their middle is used.
        const Vector3 middle = X_W1 * Vector3(0.5 * (p1 + p2));
        distance.n_W = -(X_W1.linear() * normal);
        distance.p_first_W = middle + 0.5 * distance.d * distance.n_W;
        distance.p_second_W = middle - 0.5 * distance.d * distance.n_W;
        good = is_good(distance);
      }
      if (good) distance.n_W.normalize();
    } catch (...) {
      good = false;  // a control step has to continue
    }
  }
  if (!good) {
    // No direction was found, in deep contact or for invalid input: apart along the line of centres.
    distance.d = 0.0;
    const Vector3 between = X_W1.translation() - X_W2.translation();
    const double length = between.norm();
    distance.n_W = length > 1e-12 && std::isfinite(length) ? Vector3(between / length) : Vector3(Vector3::UnitZ());
    distance.p_first_W = distance.p_second_W = X_W1.translation();
  }
  return distance;
}

}  // namespace moma
