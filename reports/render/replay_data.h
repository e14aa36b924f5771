#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace moma::reports {

/// A trial's time series as the store holds it (docs/reference/store.md, layout 1).
struct StoredSamples {
  int layout = 0;
  long long n = 0;
  std::vector<std::string> columns;
  std::string_view data;  ///< one zstd frame
};

/// The same, owned: a trial simulated again.
struct OwnedSamples {
  int layout = 0;
  long long n = 0;
  std::vector<std::string> columns;
  std::vector<unsigned char> data;
  StoredSamples view() const { return {layout, n, columns, {reinterpret_cast<const char*>(data.data()), data.size()}}; }
};

/// All values, column by column, n each. Throws std::runtime_error on data that does not fit its layout.
std::vector<double> unpack(const StoredSamples& samples);

/// `{"hz", "n", "columns", "data"}`: the motion at about `hz` samples a second (first and last always kept), as
/// float32 columns one after the other, their bytes regrouped by significance, deflated (zlib), in base64.
/// Columns: t, base_x, base_y, base_phi, q0..., command0..., error_rotation, error_position, slack (norms),
/// manipulability, least_distance, status, fallback, active_rows; of a controller that looks ahead also every plan_...
/// that the samples have (store.md), detour, detour_x and detour_y. Throws std::runtime_error on data that does
/// not fit its layout.
nlohmann::ordered_json replay_data(const StoredSamples& samples, double hz);

}  // namespace moma::reports
