#include "controller/plan/edge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

// Shorter drives have no direction worth turning to [m].
constexpr double kNoWay = 1e-4;

Trapezoid arm_time(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b) noexcept {
  double at_speed = 0.0, square = 0.0;
  for (int i = 0; i < limits.num_joints(); ++i) {
    const double way = std::abs(b[3 + i] - a[3 + i]);
    at_speed = std::max(at_speed, way / limits.joint_speed[i]);
    square = std::max(square, way / limits.joint_acceleration[i]);
  }
  return at_speed < 1e-9 ? Trapezoid{} : quickest(at_speed, square);
}

// A differential base turns to its way, drives and turns to the end's heading.
void lead_differential(const MotionLimits& limits, Edge& edge) noexcept {
  const WholeConfiguration &a = edge.a, &b = edge.b;
  const Vector2 d = b.head<2>() - a.head<2>();
  const double length = d.norm();
  if (length < kNoWay) {
    edge.turn1 = wrapped(b[2] - a[2]);
    return;
  }
  const double bearing = std::atan2(d.y(), d.x());
  const double f1 = wrapped(bearing - a[2]), f2 = wrapped(b[2] - bearing);
  const double r1 = wrapped(bearing + std::numbers::pi - a[2]), r2 = wrapped(b[2] - bearing - std::numbers::pi);
  const bool forwards = std::abs(f1) + std::abs(f2) <= std::abs(r1) + std::abs(r2) + limits.facing;
  edge.turn1 = forwards ? f1 : r1;
  edge.turn2 = forwards ? f2 : r2;
  edge.drive = forwards ? length : -length;
}

}  // namespace

void make_edge(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b,
               Edge& edge) noexcept {
  edge.a = a;
  edge.b = b;
  edge.turn1 = edge.turn2 = edge.drive = 0.0;
  edge.first = edge.middle = edge.last = {};
  edge.arm = arm_time(limits, a, b);
  if (limits.base->nonholonomic()) {
    lead_differential(limits, edge);
    edge.first = quickest_way(edge.turn1, limits.angular, limits.angular_acceleration);
    edge.middle = quickest_way(edge.drive, limits.linear, limits.linear_acceleration);
    edge.last = quickest_way(edge.turn2, limits.angular, limits.angular_acceleration);
  } else if (limits.base->lateral()) {
    edge.drive = (b.head<2>() - a.head<2>()).norm();
    edge.turn1 = wrapped(b[2] - a[2]);
    const double turn = std::abs(edge.turn1);
    if (edge.drive > 1e-9 || turn > 1e-9)
      edge.middle = quickest(std::max(edge.drive / limits.linear, turn / limits.angular),
                             std::max(edge.drive / limits.linear_acceleration, turn / limits.angular_acceleration));
  }
  edge.time = std::max({edge.base_time(), edge.arm.time, 1e-6});
}

void edge_point(const MotionLimits& limits, const Edge& edge, double part, WholeConfiguration& c) noexcept {
  if (limits.mobile())
    edge_at(limits, edge, part * edge.time, c);
  else
    c = edge.a + part * (edge.b - edge.a);
}

void edge_at(const MotionLimits& limits, const Edge& edge, double t, WholeConfiguration& c) noexcept {
  const double share = edge.arm.time > 0.0 ? edge.arm.stretched(edge.time / edge.arm.time).part(t) : 1.0;
  c = edge.a;
  const Eigen::Index joints = limits.num_joints();
  c.tail(joints) += share * (edge.b - edge.a).tail(joints);
  const double base = edge.base_time();
  if (base <= 0.0) return;
  double x = std::clamp(t / edge.time, 0.0, 1.0) * base;  // slower where the arm takes longer
  if (limits.base->lateral()) {
    const double part = edge.middle.part(x);
    c.head<2>() += part * (edge.b - edge.a).head<2>();
    c[2] += part * edge.turn1;
    return;
  }
  c[2] += edge.first.part(x) * edge.turn1;
  x -= edge.first.time;
  if (x <= 0.0) return;
  c.head<2>() += edge.middle.part(x) * (edge.b - edge.a).head<2>();
  x -= edge.middle.time;
  if (x <= 0.0) return;
  c[2] += edge.last.part(x) * edge.turn2;
}

double longest_way(const MotionLimits& limits, const Edge& edge) noexcept {
  double way = std::abs(edge.drive) + limits.base_lever * (std::abs(edge.turn1) + std::abs(edge.turn2));
  for (int i = 0; i < limits.num_joints(); ++i) way += limits.lever[i] * std::abs(edge.b[3 + i] - edge.a[3 + i]);
  return way;
}

double edge_time(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b) noexcept {
  Edge edge;
  make_edge(limits, a, b, edge);
  return edge.time;
}

void head_along(const MotionLimits& limits, const WholeConfiguration& a, double near, WholeConfiguration& b) noexcept {
  if (limits.base->nonholonomic()) {
    const Vector2 way = b.head<2>() - a.head<2>();
    if (way.norm() > near) {
      const double bearing = std::atan2(way.y(), way.x());
      b[2] = std::abs(wrapped(bearing - b[2])) < std::numbers::pi / 2.0 ? bearing : bearing + std::numbers::pi;
    }
  }
  b[2] = a[2] + wrapped(b[2] - a[2]);
}

}  // namespace moma
