#include "eval/identify/found_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/config/json_node.h"
#include "controller/config/yaml_text.h"
#include "world/sensing/disturbances_file.h"

namespace moma::identify {
namespace {

// Rounds to three digits, the accuracy of the estimates.
double rounded(double value) {
  if (!(std::abs(value) > 1e-6)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return std::stod(fmt::format("{:.3g}", std::round(value / unit) * unit));
}

// Rounds a latency to a tenth of a millisecond.
double time(double seconds) { return std::round(1e4 * std::max(0.0, seconds)) / 1e4; }

std::string yaml(const Json& json) { return config::to_yaml(config::node_from_json(json, "")); }

std::string head(const Found& found, const std::string& source) {
  std::string text =
      fmt::format("Found by moma identify in {} ({} rows of {:.4g} s).\n", source, found.rows, found.period);
  for (const std::string& note : found.notes) text += "Not found: " + note + ".\n";
  return text;
}

std::string ramps(const FoundBase& base) {
  const auto text = [](const Drive& drive) {
    return drive.acceleration ? fmt::format("{:.3g}", *drive.acceleration)
                              : fmt::format("at least {:.3g}", drive.least_acceleration);
  };
  return fmt::format("[{}, {}]", text(base.linear), text(base.turn));
}

}  // namespace

Disturbances disturbances_of(const Found& found) {
  Disturbances out;
  if (found.base) {
    const FoundBase& base = *found.base;
    out.base.noise = {rounded(base.position_noise.value_or(0.0)), rounded(base.heading_noise.value_or(0.0))};
    out.base.velocity_noise = {rounded(base.linear.velocity_noise), rounded(base.turn.velocity_noise)};
    out.base.delay = time(base.latency.sensing);
    out.base.irregularity.jitter = time(base.latency.jitter);
    out.actuators.base.delay = time(base.latency.drive);
    out.actuators.base.gain_error = {rounded(std::abs(base.linear.gain - 1.0)),
                                     rounded(std::abs(base.turn.gain - 1.0))};
  }
  if (found.joints) {
    const FoundJoints& joints = *found.joints;
    out.joints.noise = rounded(joints.position_noise.value_or(0.0));
    out.joints.velocity_noise = rounded(joints.velocity_noise);
    out.joints.delay = time(joints.latency.sensing);
    out.joints.irregularity.jitter = time(joints.latency.jitter);
    out.actuators.joints.delay = time(joints.latency.drive);
    out.actuators.joints.gain_error = rounded(joints.gain_deviation);
  }
  if (found.objects) {
    out.objects.noise.position = rounded(found.objects->position_noise);
    out.objects.delay = time(found.objects->sensing.value_or(0.0));
  }
  return out;
}

std::string disturbances_file(const Found& found, const std::string& source) {
  std::string text = head(found, source);
  if (found.base) {
    text += fmt::format("The base's ramps belong into the robot's file: base: {{max_acceleration: {}}}.\n",
                        ramps(*found.base));
  }
  return config::yaml_comment(text) + yaml(to_json(disturbances_of(found)));
}

std::string controller_file(const Found& found, const std::string& source) {
  const Disturbances d = disturbances_of(found);
  Json drives = Json::object(), sensing = Json::object(), uncertainty = Json::object();
  if (found.base) {
    drives["base"] = d.actuators.base.delay;
    sensing["base"] = d.base.delay;
    uncertainty["base"] = {{"position", d.base.noise.position}, {"rotation", d.base.noise.rotation}};
  }
  if (found.joints) {
    drives["joints"] = d.actuators.joints.delay;
    sensing["joints"] = d.joints.delay;
    uncertainty["joints"] = d.joints.noise;
  }
  if (found.objects) {
    if (found.objects->sensing) sensing["objects"] = d.objects.delay;
    uncertainty["objects"] = {{"noise", {{"position", d.objects.noise.position}}}};
  }
  std::string text = head(found, source);
  text += "With what moma-safe.yaml has: include: moma-safe.yaml.\n";
  if (!found.objects || !found.objects->sensing)
    text += "prediction.sensing.objects and .goal have to be known from elsewhere.\n";
  Json prediction = Json::object();
  if (!drives.empty()) prediction["drives"] = std::move(drives);
  if (!sensing.empty()) prediction["sensing"] = std::move(sensing);
  return config::yaml_comment(text) +
         yaml({{"prediction", std::move(prediction)}, {"uncertainty", std::move(uncertainty)}});
}

std::string summary(const Found& found) {
  std::string out = fmt::format("{} rows of {:.4g} s\n", found.rows, found.period);
  const auto latency = [&out](const char* of, const Latency& l) {
    out += fmt::format("{:<10} from a command to its measured velocity {:.4g} s: ", of, l.round_trip);
    out += l.has_stamps ? fmt::format("drive {:.4g} s, sensing {:.4g} s by its stamps\n", l.drive, l.sensing)
                        : std::string("ascribed to the drive, without stamps\n");
  };
  if (found.base) {
    const FoundBase& b = *found.base;
    latency("base", b.latency);
    out += fmt::format("{:<10} max_acceleration {} m/s^2, rad/s^2\n", "", ramps(b));
    out += fmt::format("{:<10} gains {:.4f}, {:.4f}\n", "", b.linear.gain, b.turn.gain);
    out += fmt::format("{:<10} noise of velocities {:.3g} m/s, {:.3g} rad/s", "", b.linear.velocity_noise,
                       b.turn.velocity_noise);
    if (b.position_noise) out += fmt::format("; of the pose {:.3g} m, {:.3g} rad", *b.position_noise, *b.heading_noise);
    out += "\n";
  }
  if (found.joints) {
    const FoundJoints& j = *found.joints;
    latency("joints", j.latency);
    out += fmt::format("{:<10} gains off by {:.2g} (root mean square)\n", "", j.gain_deviation);
    out += fmt::format("{:<10} noise of velocities {:.3g} rad/s", "", j.velocity_noise);
    if (j.position_noise) out += fmt::format("; of positions {:.3g} rad", *j.position_noise);
    out += "\n";
  }
  if (found.objects) {
    out += fmt::format("{:<10} noise of positions {:.3g} m", "objects", found.objects->position_noise);
    if (found.objects->sensing) out += fmt::format(", measured {:.4g} s before", *found.objects->sensing);
    out += "\n";
  }
  for (const std::string& note : found.notes) out += "note: " + note + "\n";
  return out;
}

}  // namespace moma::identify
