#include "reports/render/mesh_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>

#include "reports/render/packed.h"

namespace moma::reports {
namespace {

using Cell = std::array<std::int64_t, 3>;

/// Rotates the indices until the least is first, so that equal oriented triangles are equal triples.
std::array<int, 3> turned(const std::array<int, 3>& t) {
  const auto first = std::ranges::min_element(t) - t.begin();
  return {t[static_cast<std::size_t>(first)], t[static_cast<std::size_t>((first + 1) % 3)],
          t[static_cast<std::size_t>((first + 2) % 3)]};
}

void add_surface(const Surface& surface, Json& out) {
  if (surface.vertices.size() > 0x10000) throw std::runtime_error("a mesh has too many vertices for the page");
  Point3 low = surface.vertices.front();
  Point3 high = low;
  for (const Point3& p : surface.vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double step = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-9}) / 65535.0;
  std::vector<std::uint16_t> places;
  for (const Point3& p : surface.vertices)
    for (std::size_t k = 0; k < 3; ++k)
      places.push_back(static_cast<std::uint16_t>(std::lround((p[k] - low[k]) / step)));
  std::vector<std::uint16_t> changes;
  int last = 0;
  for (const auto& triangle : surface.triangles) {
    for (const int index : triangle) {
      changes.push_back(static_cast<std::uint16_t>(index - last));
      last = index;
    }
  }
  out["n"] = surface.vertices.size();
  out["low"] = low;
  out["step"] = step;
  out["vertices"] = packed(planes(places));
  out["triangles"] = packed(planes(changes));
}

}  // namespace

Surface clustered(const Surface& surface, double cell) {
  struct Cluster {
    Point3 sum{};
    int n = 0;
    int index = -1;
  };
  std::map<Cell, Cluster> clusters;
  std::vector<Cluster*> of;
  of.reserve(surface.vertices.size());
  for (const Point3& p : surface.vertices) {
    Cell at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = static_cast<std::int64_t>(std::floor(p[k] / cell));
    Cluster& cluster = clusters[at];
    for (std::size_t k = 0; k < 3; ++k) cluster.sum[k] += p[k];
    ++cluster.n;
    of.push_back(&cluster);
  }
  Surface out;
  std::set<std::array<int, 3>> seen;
  for (const auto& triangle : surface.triangles) {
    std::array<Cluster*, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = of[static_cast<std::size_t>(triangle[k])];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::array<int, 3> indices{};
    for (std::size_t k = 0; k < 3; ++k) {
      Cluster& corner = *corners[k];
      if (corner.index < 0) {
        corner.index = static_cast<int>(out.vertices.size());
        out.vertices.push_back({corner.sum[0] / corner.n, corner.sum[1] / corner.n, corner.sum[2] / corner.n});
      }
      indices[k] = corner.index;
    }
    if (seen.insert(turned(indices)).second) out.triangles.push_back(indices);
  }
  return out;
}

Json mesh_data(const std::vector<VisualPart>& parts, std::size_t most) {
  std::vector<Surface> surfaces(parts.size());
  std::size_t total = most + 1;
  for (double cell = 0.0005; total > most; cell *= 1.25) {
    total = 0;
    for (std::size_t i = 0; i < parts.size() && total <= most; ++i) {
      surfaces[i] = clustered(parts[i].surface, cell);
      total += surfaces[i].triangles.size();
    }
  }
  Json all = Json::array();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const VisualPart& part = parts[i];
    if (part.shape.is_null() && surfaces[i].triangles.empty()) continue;
    Json out = {{"link", part.link}, {"position", part.position}, {"rotation", part.rotation}};
    if (part.colour) out["colour"] = *part.colour;
    if (part.shape.is_null()) {
      add_surface(surfaces[i], out);
    } else {
      out.update(part.shape);
    }
    all.push_back(std::move(out));
  }
  return all;
}

}  // namespace moma::reports
