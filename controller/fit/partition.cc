#include "controller/fit/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace moma::fit {

namespace {

constexpr int kSlabs = 12;                 // number of slabs between possible cuts of a part
constexpr int kSlabPoints = 96;            // number of extreme points per slab in quick fits
constexpr std::size_t kManyPoints = 1000;  // from here on a hull is faster than comparing all points
constexpr int kQuickSamples = 1024;        // samples of a union's volume in the comparison of cuts
constexpr int kSamples = 8192;
constexpr std::size_t kThorough = 3;  // number of cuts that are fitted with all their points

constexpr double kSameAxis = 0.98;  // cosine

// Part of a surface with the best shape around it.
struct Part {
  Triangles surface;
  Points points;  // all corners
  Solid solid;
  Matrix3 axes = Matrix3::Identity();  // axes of its box
};

Part make_part(Triangles surface, const Kinds& kinds) {
  Part part;
  part.points = corners(surface);
  part.surface = std::move(surface);
  const Points hull = hull_points(part.points);
  part.solid = best_solid(hull, kinds, Effort::kThorough);
  part.axes = enclosing_box(hull, Effort::kQuick).X_LS.linear();
  return part;
}

using Parts = std::vector<Part>;

// Cost: volume of the union times the mean weight of its kinds.
double cost_of(const std::vector<Solid>& solids, const Kinds& kinds, int samples) {
  double sum = 0.0, weighted = 0.0;
  for (const Solid& solid : solids) {
    sum += volume(solid.shape);
    weighted += weight(solid.shape.kind, kinds) * volume(solid.shape);
  }
  return union_volume(solids, samples) * weighted / sum;
}

double cost_of(const Parts& parts, const Kinds& kinds) {
  std::vector<Solid> solids;
  for (const Part& part : parts) solids.push_back(part.solid);
  return cost_of(solids, kinds, kSamples);
}

// A cut of part `which` across `axis` at these positions, in ascending order.
struct Cut {
  const Parts* of = nullptr;
  std::size_t which = 0;
  Vector3 axis = Vector3::UnitX();
  std::vector<double> at;
  double cost = 0.0;  // by quick fits
};

// One part in slabs across one axis, with quick fits around runs of neighbouring slabs.
class Slabs {
 public:
  Slabs(const Part& part, const Vector3& axis, const Kinds& kinds) : kinds_(kinds) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Vector3& p : part.points) {
      low = std::min(low, axis.dot(p));
      high = std::max(high, axis.dot(p));
    }
    for (int i = 0; i <= kSlabs; ++i) places_.push_back(i == kSlabs ? high : low + (high - low) * i / kSlabs);
    for (std::size_t i = 0; i < kSlabs; ++i) {
      Points slab = corners(clipped(part.surface, axis, places_[i], places_[i + 1]));
      if (slab.size() > kManyPoints) slab = hull_points(slab);
      points_.push_back(extreme_points(slab, kSlabPoints));
    }
  }

  double place(int i) const { return places_[static_cast<std::size_t>(i)]; }

  /// Fit around the slabs [from, to); empty if they contain no surface.
  const std::optional<Solid>& around(int from, int to) {
    const auto [entry, is_new] = fits_.try_emplace({from, to});
    if (!is_new) return entry->second;
    Points points;
    for (int i = from; i < to; ++i) {
      const Points& slab = points_[static_cast<std::size_t>(i)];
      points.insert(points.end(), slab.begin(), slab.end());
    }
    if (!points.empty()) entry->second = best_solid(extreme_points(points, kSlabPoints), kinds_, Effort::kQuick);
    return entry->second;
  }

 private:
  Kinds kinds_;
  std::vector<double> places_;
  std::vector<Points> points_;
  std::map<std::pair<int, int>, std::optional<Solid>> fits_;
};

// Adds all cuts of one part into `pieces` (2 or 3), with the resulting cost of all parts.
void add_cuts(const Parts& parts, std::size_t which, int pieces, const Kinds& kinds, std::vector<Cut>& cuts) {
  std::vector<Solid> others;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (i != which) others.push_back(parts[i].solid);
  std::vector<Vector3> axes;
  for (int a = 0; a < 3; ++a) axes.emplace_back(parts[which].axes.col(a));
  for (int a = 0; a < 3; ++a)
    if ((parts[which].axes.transpose() * Vector3::Unit(a)).cwiseAbs().maxCoeff() < kSameAxis)
      axes.emplace_back(Vector3::Unit(a));
  for (const Vector3& axis : axes) {
    Slabs slabs(parts[which], axis, kinds);
    const auto consider = [&](const std::vector<int>& at) {
      std::vector<Solid> solids = others;
      Cut cut{&parts, which, axis, {}, 0.0};
      int from = 0;
      for (std::size_t i = 0; i <= at.size(); ++i) {
        const int to = i < at.size() ? at[i] : kSlabs;
        const std::optional<Solid>& solid = slabs.around(from, to);
        if (!solid) return;
        solids.push_back(*solid);
        if (i < at.size()) cut.at.push_back(slabs.place(to));
        from = to;
      }
      cut.cost = cost_of(solids, kinds, kQuickSamples);
      cuts.push_back(std::move(cut));
    };
    for (int i = 1; i < kSlabs; ++i) {
      if (pieces == 2) consider({i});
      for (int j = i + 1; pieces == 3 && j < kSlabs; ++j) consider({i, j});
    }
  }
}

Parts applied(const Cut& cut, const Kinds& kinds) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const Parts& parts = *cut.of;
  Parts result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i != cut.which) {
      result.push_back(parts[i]);
      continue;
    }
    for (std::size_t k = 0; k <= cut.at.size(); ++k) {
      const double low = k == 0 ? -kFar : cut.at[k - 1];
      const double high = k < cut.at.size() ? cut.at[k] : kFar;
      Triangles surface = clipped(parts[i].surface, cut.axis, low, high);
      if (!surface.empty()) result.push_back(make_part(std::move(surface), kinds));
    }
  }
  return result;
}

// Returns the best of the most promising cuts; empty if nothing can be cut.
Parts best_cut(const Parts& whole, const Parts& parts, const Kinds& kinds) {
  std::vector<Cut> cuts;
  for (std::size_t i = 0; i < parts.size(); ++i) add_cuts(parts, i, 2, kinds, cuts);
  if (parts.size() == 2) add_cuts(whole, 0, 3, kinds, cuts);
  std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.cost < b.cost; });
  Parts best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(kThorough, cuts.size()); ++i) {
    Parts next = applied(cuts[i], kinds);
    const double cost = cost_of(next, kinds);
    if (cost >= least) continue;
    least = cost;
    best = std::move(next);
  }
  return best;
}

}  // namespace

std::vector<Placed> fit_surfaces(const std::vector<Triangles>& surfaces, const FitOptions& options) {
  const Parts whole{make_part(together(surfaces), options.kinds)};
  Parts current = whole;
  Parts best = whole;
  double least = cost_of(whole, options.kinds);
  for (int count = 2; count <= options.max_shapes; ++count) {
    Parts next = best_cut(whole, current, options.kinds);
    if (count == static_cast<int>(surfaces.size())) {
      Parts one_by_one;
      for (const Triangles& surface : surfaces) one_by_one.push_back(make_part(surface, options.kinds));
      if (next.empty() || cost_of(one_by_one, options.kinds) < cost_of(next, options.kinds))
        next = std::move(one_by_one);
    }
    if (next.empty()) break;
    current = std::move(next);
    const double cost = cost_of(current, options.kinds) * std::pow(kGain, static_cast<double>(current.size()) - 1.0);
    if (cost >= least) continue;
    least = cost;
    best = current;
  }
  std::vector<Placed> shapes;
  for (const Part& part : best) shapes.push_back(rounded(part.solid, part.points));
  return shapes;
}

double weight(ShapeKind kind, const Kinds& kinds) noexcept {
  return kind == ShapeKind::kBox ? kinds.box_weight : kind == ShapeKind::kCapsule ? kCapsuleWeight : 1.0;
}

Solid best_solid(const Points& points, const Kinds& kinds, Effort effort) {
  Solid best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Solid& solid) {
    const double cost = weight(solid.shape.kind, kinds) * volume(solid.shape);
    if (cost >= least) return;
    least = cost;
    best = solid;
  };
  if (kinds.sphere) consider(enclosing_sphere(points));
  if (kinds.capsule) consider(enclosing_capsule(points, effort));
  if (kinds.box) consider(enclosing_box(points, effort));
  return best;
}

}  // namespace moma::fit
