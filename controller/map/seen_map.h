#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/map/gaze.h"
#include "controller/map/map_box.h"
#include "controller/map/occupancy_map.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/sensor_frames.h"
#include "controller/step.h"

namespace moma {

/// A map of the robot's surroundings from its sensors' frames, in the axes of the measured base pose. The rest of the
/// controller gets it as objects: boxes at rest that cover the occupied cells near the robot, and boxes with
/// ObjectState::seen false that cover the unseen ones next to it. A fixed number of objects has them, so that whatever
/// asks for distances to objects asks the map as well.
///
/// A frame counts from where the robot was when it was taken, by the measurements of that time. Points on the robot
/// itself are left out, and where the robot is, is free. Each step takes frames until MapParams::rays are used up, in
/// the order of their time; the newest frame of a sensor replaces one that waits. Only reset() allocates.
class SeenMap {
 public:
  /// `base_age`, `joint_age`: age of the measurements of base and joints [s].
  SeenMap(std::shared_ptr<const RobotModel> model, const MapParams& params, double base_age, double joint_age);

  bool on() const noexcept { return params_.enabled; }
  /// Number of objects that the map has for its boxes.
  std::size_t count() const noexcept { return on() ? states_.size() : 0; }
  /// Their shapes, after the objects that are told. Allocates.
  void append_shapes(std::vector<ObjectShape>& objects) const;

  void reset();
  void see(const DepthFrame& frame) noexcept;
  /// Takes the measured state of a step and works on frames.
  void observe(const Observation& o) noexcept;
  /// True until each sensor that sends frames has had one in the map.
  bool waits() const noexcept;
  /// The boxes, as many as count().
  std::span<const ObjectState> states() const noexcept { return states_; }
  /// The same without those that hold nothing. Allocates.
  std::vector<MapBox> boxes() const;
  /// Takes the boxes of another map with these parameters, in place of its own, until the next frame. Boxes of objects
  /// that this map does not have are left out.
  void set_boxes(std::span<const MapBox> boxes) noexcept;
  /// Returns where a sensor's head should look: at the unseen space next to the robot.
  Gaze gaze(int sensor) const noexcept;
  const OccupancyMap& map() const noexcept { return map_; }
  /// Number of boxes of occupied space that found no place among them, of the last step that made boxes.
  int left_out() const noexcept { return left_out_; }

 private:
  struct Waiting {
    explicit Waiting(const MountedSensor& sensor)
        : mounted(&sensor), directions_C(RayView(sensor.sensor).directions_C()), choice(sensor) {}

    const MountedSensor* mounted;
    std::vector<Vector3> directions_C;
    DepthFrame frame;
    GazeChoice choice;
    bool waits = false, had = false, looked = false;
  };
  struct Moment {
    double time = -kNever;
    Vector3 base = Vector3::Zero();
    VectorX q;
  };
  static constexpr double kNever = 1e9;

  void take(Waiting& sensor) noexcept;
  bool own(const Vector3& p_W) const noexcept;
  void free_near(const Shape& shape, const Isometry& X_WS, double margin, bool surely) noexcept;
  void believe_start() noexcept;
  void place_robot(const Vector3& base, const VectorX& q) noexcept;
  CellBox region(const Vector3& low, const Vector3& high) const noexcept;
  // The boxes of a kind of cells, and those that are objects. A box that stays keeps its object.
  struct Kind {
    OccupancyMap::Kind kind;
    std::vector<CellBox> boxes;    // from the window's first cell
    std::vector<CellBox> objects;  // of its objects, from the world's origin; of no cells: none
    std::span<ObjectState> states;
  };
  void look() noexcept;
  double squared_gap(const Eigen::AlignedBox3d& box) const noexcept;
  void make_boxes(Kind& kind, const CellBox& region) noexcept;

  std::shared_ptr<const RobotModel> model_;
  MapParams params_;
  double base_age_, joint_age_;
  OccupancyMap map_;
  Kinematics robot_;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> shapes_X_WS_, shapes_X_SW_;
  std::vector<Eigen::AlignedBox3d> around_;  // boxes around the shapes
  Eigen::AlignedBox3d around_robot_;
  std::vector<Waiting> sensors_;
  std::vector<Moment> base_log_, joint_log_;  // rings
  std::size_t logged_ = 0;
  Kind occupied_{OccupancyMap::Kind::kOccupied, {}, {}, {}}, unseen_{OccupancyMap::Kind::kUnseen, {}, {}, {}};
  double made_at_ = -kNever, merged_at_ = -kNever;  // times of the last boxes, and of boxes from nothing [s]
  std::vector<std::pair<double, int>> order_;
  std::vector<CellBox> chosen_;
  std::vector<char> kept_;
  std::vector<ObjectState> states_;
  std::vector<Sight> sights_;
  bool begun_ = false;
  int left_out_ = 0;
};

}  // namespace moma
