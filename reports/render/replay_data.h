#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reports/render/json.h"

namespace moma::reports {

/// A trial's time series as the store holds it (docs/reference/store.md, layout 1).
struct StoredSamples {
  int layout = 0;
  long long n = 0;
  std::vector<std::string> columns;
  std::string_view data;  ///< one zstd frame
};

/// The QP's rows about distances, as the controller posed them.
struct DistanceRows {
  enum class Kind { kObject, kFloor, kSelf };
  struct Row {
    double t = 0.0;  ///< of the control step [s]
    Kind kind = Kind::kObject;
    int first = 0;                       ///< index into `names`: the robot's link
    int second = 0;                      ///< and of what it is kept from
    bool active = false;                 ///< at its limit
    double d = 0.0;                      ///< distance [m]
    std::array<double, 3> p_first_W{};   ///< nearest point of the link [m]
    std::array<double, 3> p_second_W{};  ///< and of the other [m]
  };
  std::vector<std::string> names;
  std::vector<Row> rows;  ///< by time
};

/// A controller's map in the course of a trial, and where its sensors looked.
struct MapMotion {
  struct Box {
    int from = 0, to = 0;              ///< pictures of the map: shown from one on, until before the other
    bool seen = true;                  ///< occupied; false: unseen
    std::array<int, 3> low{}, high{};  ///< corners in the world, in cells
  };
  double cell = 0.0;  ///< edge of a cell [m]; 0 without a map
  double hz = 0.0;    ///< pictures per second
  std::vector<Box> boxes;
  struct Look {
    int sensor = 0;                ///< index into the robot's sensors
    double t = 0.0;                ///< [s]
    double pan = 0.0, tilt = 0.0;  ///< angles of its head [rad]
  };
  std::vector<Look> looks;
};

/// The same, owned: a trial simulated again.
struct OwnedSamples {
  int layout = 0;
  long long n = 0;
  std::vector<std::string> columns;
  std::vector<unsigned char> data;
  DistanceRows rows;
  MapMotion map = {};
  StoredSamples view() const { return {layout, n, columns, {reinterpret_cast<const char*>(data.data()), data.size()}}; }
};

/// A trial's samples by column. Throws std::runtime_error on data that does not fit its layout.
class Samples {
 public:
  explicit Samples(const StoredSamples& stored);

  /// The values of a column; empty if there is none.
  std::optional<std::span<const double>> find(std::string_view column) const;
  /// The same; throws if there is none.
  std::span<const double> at(std::string_view column) const;

 private:
  std::size_t n_;
  std::vector<std::string> columns_;
  std::vector<double> values_;  // column by column
};

/// `{"hz", "n", "columns", "data"}`: the motion at about `hz` samples a second (first and last always kept), as
/// float32 columns one after the other, their bytes regrouped by significance, deflated (zlib), in base64.
/// Columns: t, base_x, base_y, base_phi, q0..., command0..., error_rotation, error_position, slack (norms),
/// manipulability, least_distance, status, fallback, active_rows, then all others that the samples have (store.md), to
/// 16 binary digits, of a controller that looks ahead also plan_..., detour, detour_x and detour_y. Throws
/// std::runtime_error on data that does not fit its layout. With `rows` also "rows": {"names", "n", "data"}: how many
/// rows each sample kept has, and of all of them, column by column, kind + 8 if active, first, second, d [0.1 mm], the
/// six coordinates [mm], each of 16 bits, packed() as planes. With a `map` also "map": {"cell", "hz", "data", "looks"}:
/// of all boxes, column by column, from, to, 1 if seen, the low corner, the edges [cells], packed() likewise; "looks":
/// {"n", "data"}, with the columns sensor, t, pan, tilt as float32.
Json replay_data(const StoredSamples& stored, double hz, const DistanceRows* rows = nullptr,
                 const MapMotion* map = nullptr);

}  // namespace moma::reports
