#include "controller/map/seen_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "controller/model/analytic_distance.h"

namespace moma {
namespace {

constexpr std::size_t kMoments = 128;     // remembered steps
constexpr std::size_t kMostFound = 4096;  // boxes among which the nearest are chosen
constexpr int kLevels = 3;                // of rays that begin at the sensor, further from it, ...

Eigen::AlignedBox3d box_around(const Shape& shape, const Isometry& X_WS) noexcept {
  Vector3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    high[axis] = extent_along(shape, X_WS, Vector3::Unit(axis));
    low[axis] = -extent_along(shape, X_WS, -Vector3::Unit(axis));
  }
  return {low, high};
}

}  // namespace

SeenMap::SeenMap(std::shared_ptr<const RobotModel> model, const MapParams& params, double base_age, double joint_age)
    : model_(std::move(model)),
      params_(params),
      base_age_(base_age),
      joint_age_(joint_age),
      map_(params.enabled ? params : MapParams{.window = 1.0, .height = 0.1, .evidence = {}, .unseen = {}}),
      robot_(model_) {
  reset();
}

void SeenMap::append_shapes(std::vector<ObjectShape>& objects) const {
  const double longest = OccupancyMap::kLongest * params_.cell;
  for (std::size_t i = 0; i < count(); ++i) {
    const bool seen = i < static_cast<std::size_t>(params_.boxes);
    objects.push_back(
        {(seen ? "map" : "unseen") + std::to_string(i), {ShapeKind::kBox, Vector3::Constant(longest), nullptr}});
  }
}

void SeenMap::reset() {
  if (!on()) return;
  begun_ = false;
  logged_ = 0;
  left_out_ = 0;
  sensors_.clear();
  for (const MountedSensor& mounted : model_->sensors) {
    Waiting& sensor = sensors_.emplace_back(mounted);
    sensor.frame.ranges = VectorX::Zero(static_cast<Eigen::Index>(sensor.directions_C.size()));
  }
  const Moment none{.q = VectorX::Zero(model_->num_joints())};
  base_log_.assign(kMoments, none);
  joint_log_.assign(kMoments, none);
  ObjectState hidden;
  hidden.visible = false;
  const auto boxes = static_cast<std::size_t>(params_.boxes);
  states_.assign(static_cast<std::size_t>(params_.num_objects()), hidden);
  occupied_.states = std::span(states_).first(boxes);
  unseen_.states = std::span(states_).subspan(boxes);
  for (ObjectState& state : unseen_.states) state.seen = false;
  for (Kind* kind : {&occupied_, &unseen_}) {
    kind->boxes.clear();
    kind->boxes.reserve(kMostFound);
    kind->objects.assign(kind->states.size(), CellBox{});
  }
  order_.reserve(kMostFound);
  kept_.assign(std::max(occupied_.states.size(), unseen_.states.size()), 0);
  sights_.reserve(unseen_.states.size());
  chosen_.reserve(std::max(occupied_.states.size(), unseen_.states.size()));
  shapes_X_WS_.assign(model_->shapes.size(), Isometry::Identity());
  shapes_X_SW_ = shapes_X_WS_;
  around_.assign(model_->shapes.size(), Eigen::AlignedBox3d());
  map_.clear(0.0, 0.0);
}

void SeenMap::see(const DepthFrame& frame) noexcept {
  if (!on() || frame.sensor < 0 || frame.sensor >= static_cast<int>(sensors_.size())) return;
  Waiting& sensor = sensors_[static_cast<std::size_t>(frame.sensor)];
  if (frame.ranges.size() != sensor.frame.ranges.size()) return;
  if (!std::isfinite(frame.time) || !std::isfinite(frame.gaze.pan) || !std::isfinite(frame.gaze.tilt)) return;
  sensor.frame = frame;
  sensor.waits = true;
}

std::vector<MapBox> SeenMap::boxes() const {
  std::vector<MapBox> out;
  for (std::size_t i = 0; i < count(); ++i)
    if (states_[i].visible) out.push_back({static_cast<int>(i), states_[i].X_WO.translation(), states_[i].box});
  return out;
}

void SeenMap::set_boxes(std::span<const MapBox> boxes) noexcept {
  for (ObjectState& state : states_) state.visible = false;
  for (const MapBox& box : boxes) {
    if (static_cast<std::size_t>(box.object) >= count()) continue;
    ObjectState& state = states_[static_cast<std::size_t>(box.object)];
    state.visible = true;
    state.X_WO.translation() = box.p_W;
    state.box = box.size;
  }
}

Gaze SeenMap::gaze(int sensor) const noexcept {
  const auto i = static_cast<std::size_t>(sensor);
  return i < sensors_.size() ? sensors_[i].choice.wanted() : Gaze{};
}

bool SeenMap::waits() const noexcept {
  return std::any_of(sensors_.begin(), sensors_.end(), [](const Waiting& s) { return s.waits && !s.had; });
}

void SeenMap::observe(const Observation& o) noexcept {
  if (!on()) return;
  Moment& moment = base_log_[logged_ % kMoments];
  moment.time = o.time - base_age_;
  moment.base = o.base;
  Moment& joints = joint_log_[logged_ % kMoments];
  joints.time = o.time - joint_age_;
  joints.q = o.q;
  ++logged_;
  if (std::none_of(sensors_.begin(), sensors_.end(), [](const Waiting& s) { return s.waits; })) return;
  if (!begun_) {
    begun_ = true;
    made_at_ = merged_at_ = -kNever;
    map_.centre(o.base.x(), o.base.y());
    place_robot(o.base, o.q);
    if (params_.unseen.enabled) believe_start();
  }
  const Eigen::Vector3i origin = map_.origin();
  if (map_.centre(o.base.x(), o.base.y())) {
    for (CellBox& box : occupied_.boxes) {
      box.low += origin - map_.origin();
      box.high += origin - map_.origin();
    }
  }
  for (long rays = 0; rays < params_.rays;) {
    Waiting* first = nullptr;
    for (Waiting& sensor : sensors_)
      if (sensor.waits && (first == nullptr || sensor.frame.time < first->frame.time)) first = &sensor;
    if (first == nullptr) break;
    take(*first);
    rays += first->frame.ranges.size();
  }
  place_robot(o.base, o.q);
  for (std::size_t i = 0; i < shapes_X_WS_.size(); ++i) free_near(model_->shapes[i].shape, shapes_X_WS_[i], 0.0, true);
  look();
  if (o.time - made_at_ < params_.often && !map_.uncovered()) return;
  made_at_ = o.time;
  if (o.time - merged_at_ >= params_.merge) {
    merged_at_ = o.time;
    occupied_.boxes.clear();
  }
  if (params_.unseen.enabled) {
    // Above the robot nothing is asked of unseen space.
    const Vector3 more(params_.unseen.range, params_.unseen.range, 0.0);
    unseen_.boxes.clear();
    make_boxes(unseen_, region(around_robot_.min() - more, around_robot_.max() + more));
  }
  left_out_ = 0;
  const Vector3 at(o.base.x(), o.base.y(), 0.0), reach(params_.reach, params_.reach, params_.height);
  make_boxes(occupied_, region(at - reach, at + reach));
}

// Heads whose frames were taken choose where to look next: unseen boxes are worth a look by how near they are.
void SeenMap::look() noexcept {
  const auto chooses = [](const Waiting& s) { return s.looked && s.choice.on(); };
  if (std::none_of(sensors_.begin(), sensors_.end(), chooses)) return;
  sights_.clear();
  for (const ObjectState& state : unseen_.states) {
    if (!state.visible) continue;
    const Vector3& p = state.X_WO.translation();
    const Eigen::AlignedBox3d box(p - 0.5 * state.box, p + 0.5 * state.box);
    sights_.push_back({p, 1.0 / (std::sqrt(squared_gap(box)) + params_.unseen.influence)});
  }
  for (Waiting& sensor : sensors_) {
    if (chooses(sensor))
      sensor.choice.saw(sensor.frame.gaze, sensor.frame.time, robot_.X_WL(sensor.mounted->link), sights_);
    sensor.looked = false;
  }
}

// Between a box and the boxes around the robot's shapes.
double SeenMap::squared_gap(const Eigen::AlignedBox3d& box) const noexcept {
  double nearest = kNever;
  for (const Eigen::AlignedBox3d& part : around_) nearest = std::min(nearest, part.squaredExteriorDistance(box));
  return nearest;
}

void SeenMap::place_robot(const Vector3& base, const VectorX& q) noexcept {
  robot_.place(base, q);
  Eigen::AlignedBox3d whole;
  for (std::size_t i = 0; i < shapes_X_WS_.size(); ++i) {
    shapes_X_WS_[i] = robot_.X_WS(model_->shapes[i]);
    shapes_X_SW_[i] = shapes_X_WS_[i].inverse(Eigen::Isometry);
    around_[i] = box_around(model_->shapes[i].shape, shapes_X_WS_[i]);
    whole.extend(around_[i]);
  }
  around_robot_ = whole;
}

bool SeenMap::own(const Vector3& p_W) const noexcept {
  constexpr double kRounding = 1e-9;
  const double near = params_.own * params_.own + kRounding;
  if (around_robot_.squaredExteriorDistance(p_W) > near) return false;
  for (std::size_t i = 0; i < shapes_X_SW_.size(); ++i)
    if (around_[i].squaredExteriorDistance(p_W) <= near &&
        point_gap(model_->shapes[i].shape, shapes_X_SW_[i] * p_W) <= params_.own)
      return true;
  return false;
}

void SeenMap::take(Waiting& sensor) noexcept {
  sensor.waits = false;
  sensor.had = sensor.looked = true;
  const auto nearest = [&](const std::vector<Moment>& log) -> const Moment& {
    return *std::min_element(log.begin(), log.end(), [&](const Moment& a, const Moment& b) {
      return std::abs(a.time - sensor.frame.time) < std::abs(b.time - sensor.frame.time);
    });
  };
  place_robot(nearest(base_log_).base, nearest(joint_log_).q);
  const Isometry X_WC = robot_.X_WL(sensor.mounted->link) * sensor.mounted->turned(sensor.frame.gaze);
  const Vector3 from = X_WC.translation();
  const double range = sensor.mounted->sensor.range;
  if (!is_pose(X_WC)) return;
  VectorX& ranges = sensor.frame.ranges;
  for (Eigen::Index i = 0; i < ranges.size(); ++i) {
    const double r = ranges[i];
    if (!(r > 0.0) || r > range) continue;
    const Vector3 along = X_WC.linear() * sensor.directions_C[static_cast<std::size_t>(i)], p = from + r * along;
    if (own(p))
      ranges[i] = 0.0;
    else if (p.z() > params_.floor)
      map_.hit(p, along);
  }
  // Near the sensor a part of the rays passes every cell: a ray begins where those of the next level are a cell apart.
  const Sensor& s = sensor.mounted->sensor;
  const double apart = std::max(s.field_of_view[0] / s.columns, s.field_of_view[1] / s.rows);
  // Ends of rays count in each frame. Of the rays as a checkerboard one colour frees cells in a frame, the other in the
  // next.
  const long colour = std::lround(sensor.frame.time * s.rate) & 1;
  std::array<double, kLevels + 1> begins{};
  for (int level = 0; level < kLevels; ++level)
    begins[static_cast<std::size_t>(level)] = map_.cell() / (apart * (2 << level));
  for (int row = 0; row < s.rows; ++row)
    for (int column = static_cast<int>((row ^ colour) & 1); column < s.columns; column += 2) {
      const int i = row * s.columns + column;
      const double r = std::min(ranges[i], range);
      if (!(r > 0.0)) continue;
      const int level = std::min(kLevels, std::countr_zero(static_cast<unsigned>(row | column)));
      const double begin = begins[static_cast<std::size_t>(level)];
      if (begin >= r) continue;
      const Vector3 along = X_WC.linear() * sensor.directions_C[static_cast<std::size_t>(i)];
      map_.pass(from + begin * along, from + r * along);
    }
  map_.end();
}

// Cells whose middle is within `margin` of a shape are free.
void SeenMap::free_near(const Shape& shape, const Isometry& X_WS, double margin, bool surely) noexcept {
  const Vector3 half = Vector3::Constant(0.5 * map_.cell());
  const Isometry X_SW = X_WS.inverse(Eigen::Isometry);
  const Eigen::AlignedBox3d around = box_around(shape, X_WS);
  const Vector3 more = Vector3::Constant(margin);
  const Eigen::Vector3i first = map_.cell_of(around.min() - more).cwiseMax(0),
                        last = map_.cell_of(around.max() + more).cwiseMin(map_.cells());
  Eigen::Vector3i c;
  for (c.x() = first.x(); c.x() <= last.x(); ++c.x())
    for (c.y() = first.y(); c.y() <= last.y(); ++c.y())
      for (c.z() = first.z(); c.z() <= last.z(); ++c.z())
        if (!map_.freed_already(c, surely) && point_gap(shape, X_SW * (map_.low_corner(c) + half)) <= margin)
          map_.take_for_free(c, surely);
}

// Frees cells at the start of a motion: those that lie within `start` of the robot's shapes as a whole, and those whose
// middle lies within `beside` of the box of its base. No sensor looks between the base, what stands on it, and the arm.
void SeenMap::believe_start() noexcept {
  Eigen::AlignedBox3d body;
  const double start = params_.unseen.start - 0.5 * std::sqrt(3.0) * map_.cell();
  for (std::size_t i = 0; i < shapes_X_WS_.size(); ++i) {
    const CollisionShape& shape = model_->shapes[i];
    free_near(shape.shape, shapes_X_WS_[i], start, false);
    if (shape.rigid_with_base)
      body.extend(box_around(shape.shape, robot_.X_WB().inverse(Eigen::Isometry) * shapes_X_WS_[i]));
  }
  if (body.isEmpty()) return;
  const Isometry X_WO = robot_.X_WB() * Eigen::Translation3d(body.center());
  free_near({ShapeKind::kBox, body.sizes(), nullptr}, X_WO, params_.unseen.beside, false);
}

// The cells above a rectangle of the floor, up to a height.
CellBox SeenMap::region(const Vector3& low, const Vector3& high) const noexcept {
  CellBox out{map_.cell_of(low), map_.cell_of(high)};
  out.high.array() += 1;
  out.low.z() = 0;
  out.high.z() = std::min(out.high.z(), map_.cells().z());
  return out;
}

// The boxes that are nearest to the robot become objects. A box that is one already keeps its place, so that whoever
// compares objects with those of before finds what has changed.
void SeenMap::make_boxes(Kind& kind, const CellBox& region) noexcept {
  map_.cover(kind.kind, region, kind.boxes);
  order_.clear();
  for (std::size_t i = 0; i < kind.boxes.size(); ++i) {
    const Vector3 low = map_.low_corner(kind.boxes[i].low), high = map_.low_corner(kind.boxes[i].high);
    order_.emplace_back(squared_gap({low, high}), static_cast<int>(i));
  }
  if (order_.size() > kind.states.size()) {
    left_out_ += static_cast<int>(order_.size() - kind.states.size());
    std::nth_element(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(kind.states.size()), order_.end());
    order_.resize(kind.states.size());
  }
  const auto by_place = [](const CellBox& a, const CellBox& b) {
    const auto both = [](const CellBox& box) {
      return std::array{box.low.x(), box.low.y(), box.low.z(), box.high.x(), box.high.y(), box.high.z()};
    };
    return both(a) < both(b);
  };
  chosen_.clear();
  for (const auto& [distance, i] : order_) {
    const CellBox& box = kind.boxes[static_cast<std::size_t>(i)];
    chosen_.push_back({box.low + map_.origin(), box.high + map_.origin()});
  }
  std::sort(chosen_.begin(), chosen_.end(), by_place);
  std::fill(kept_.begin(), kept_.end(), char{0});
  for (std::size_t i = 0; i < kind.states.size(); ++i) {
    if (!kind.states[i].visible) continue;
    const auto same = std::lower_bound(chosen_.begin(), chosen_.end(), kind.objects[i], by_place);
    if (same == chosen_.end() || by_place(kind.objects[i], *same))
      kind.states[i].visible = false;
    else
      kept_[static_cast<std::size_t>(same - chosen_.begin())] = 1;
  }
  std::size_t place = 0;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const CellBox& box = chosen_[i];
    if (kept_[i] != 0) continue;
    while (kind.states[place].visible) ++place;
    ObjectState& state = kind.states[place];
    state.visible = true;
    state.X_WO.translation() = 0.5 * map_.cell() * (box.low + box.high).cast<double>();
    state.box = map_.cell() * (box.high - box.low).cast<double>();
    kind.objects[place] = box;
  }
}

}  // namespace moma
