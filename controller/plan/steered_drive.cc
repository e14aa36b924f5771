#include "controller/plan/steered_drive.h"

namespace moma {
namespace {

constexpr double kAhead = 0.05;  // distance below which the base does not steer any more [m]
constexpr double kCrawl = 0.02;  // least speed up to the point [m/s]
constexpr int kMostSteps = static_cast<int>(SteeredDrive::kMostTime / kDriveStep);

}  // namespace

bool SteeredDrive::plan(const MotionLimits& limits, const Vector3& from, const Vector2& now, const Vector2& point,
                        const Passing* passing) noexcept {
  time_ = spacing_ = way_ = turned_ = 0.0;
  end_ = from;
  std::array<Vector2, kMostSteps + 1> speeds;  // (v, omega)
  speeds[0] = now;
  Vector3 at = from;
  const Vector2 first = point - from.head<2>();
  bool there = passing == nullptr && first.norm() < kReached;
  const double ahead = std::cos(from.z()) * first.x() + std::sin(from.z()) * first.y();
  const double direction = limits.drives_backwards(ahead, first.norm()) ? -1.0 : 1.0;
  double v = direction * now[0], omega = now[1];  // v along the driving direction
  int steps = 0;
  while (!there || v != 0.0 || omega != 0.0) {
    if (steps == kMostSteps) {
      time_ = kMostTime;
      return false;
    }
    const Vector2 to = point - at.head<2>();
    const double distance = to.norm();
    if (passing != nullptr && (distance < passing->reach || steps * kDriveStep >= passing->until)) break;
    const Vector2 heading = direction * Vector2(std::cos(at.z()), std::sin(at.z()));
    const double along = heading.dot(to), across = heading.x() * to.y() - heading.y() * to.x();
    there = there || (passing == nullptr && (distance < kReached || (distance < kAhead && along <= 0.0)));
    double wanted = 0.0, turn = 0.0;
    if (!there) {
      const double off = std::atan2(across, along);
      wanted = std::max(0.0, along / distance) *
               (passing != nullptr
                    ? std::min(limits.linear, passing->speed)
                    : std::min(limits.linear, std::max(kCrawl, stopping(distance, limits.linear_acceleration))));
      if (distance > kAhead)
        turn = std::copysign(std::min(limits.angular, stopping(std::abs(off), limits.angular_acceleration)), off);
    }
    omega = ramped(omega, turn, limits.angular_acceleration);
    v = ramped(v, std::min(wanted, std::max(0.0, limits.rim_speed - limits.half_track * std::abs(omega))),
               limits.linear_acceleration);
    const double middle = at.z() + 0.5 * omega * kDriveStep;
    at += kDriveStep * Vector3(direction * v * std::cos(middle), direction * v * std::sin(middle), omega);
    speeds[static_cast<std::size_t>(++steps)] = {direction * v, omega};
  }
  if (steps == 0) return true;
  time_ = steps * kDriveStep;
  spacing_ = time_ / (kNodes + 1);
  speed_[0] << now[0] * std::cos(from.z()), now[0] * std::sin(from.z()), now[1];
  end_.head<2>() += 0.5 * spacing_ * speed_[0].head<2>();
  way_ = 0.5 * spacing_ * std::abs(now[0]);
  turned_ = 0.5 * spacing_ * std::abs(now[1]);
  double before = now[1];
  for (int i = 1; i <= kNodes; ++i) {
    const double place = static_cast<double>(i) * steps / (kNodes + 1);
    const auto k = static_cast<std::size_t>(place);
    const Vector2 u = speeds[k] + (place - static_cast<double>(k)) * (speeds[k + 1] - speeds[k]);
    end_.z() += 0.5 * spacing_ * (before + u[1]);  // the heading that the parts have come to by then
    before = u[1];
    Vector3& node = speed_[static_cast<std::size_t>(i)];
    node << u[0] * std::cos(end_.z()), u[0] * std::sin(end_.z()), u[1];
    end_.head<2>() += spacing_ * node.head<2>();
    way_ += spacing_ * std::abs(u[0]);
    turned_ += spacing_ * std::abs(u[1]);
  }
  const Vector2& last = speeds[static_cast<std::size_t>(steps)];
  end_.z() += 0.5 * spacing_ * (before + last[1]);
  speed_.back() << last[0] * std::cos(end_.z()), last[0] * std::sin(end_.z()), last[1];
  end_.head<2>() += 0.5 * spacing_ * speed_.back().head<2>();
  return true;
}

void SteeredDrive::add_to(Path& path) const noexcept {
  if (time_ <= 0.0) return;
  const auto add = [&](double start, const Trapezoid& motion, const Vector3& change) {
    PathPart part{start, motion, WholeConfiguration::Zero(path.origin.size())};
    part.change.head<3>() = change;
    path.add(part);
  };
  if (!speed_[0].isZero(0.0)) add(0.0, {spacing_, 0.0, spacing_}, 0.5 * spacing_ * speed_[0]);
  for (int i = 1; i <= kNodes; ++i)
    add((i - 1) * spacing_, {2.0 * spacing_, spacing_, spacing_}, spacing_ * speed_[static_cast<std::size_t>(i)]);
  if (!speed_.back().isZero(0.0)) add(time_ - spacing_, {spacing_, spacing_, 0.0}, 0.5 * spacing_ * speed_.back());
  path.duration = std::max(path.duration, time_);
}

}  // namespace moma
