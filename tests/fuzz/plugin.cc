// What a plugin answers: a controller in this process whose every answer the input writes. Whatever it says, the step
// ends with a finite command within the robot's speeds, or with none and a reason that a terminal can show.
#include "plugin/host/plugin.h"
#include "controller/step.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/fuzz/values.h"

namespace moma {
namespace {

fuzz::Bytes* answers = nullptr;  // of the input that runs
std::size_t velocities = 0;

void say(char* error, std::size_t size) {
  if (error == nullptr) return;
  const std::size_t n = std::min<std::size_t>(answers->below(300) * 8, size);  // up to the last byte, without an end
  for (std::size_t i = 0; i < n; ++i) error[i] = static_cast<char>(answers->byte());
}

void* open_plugin(const moma_plugin_setup* setup, char* error, std::size_t size) {
  static int plugin = 0;
  velocities = setup->num_velocities;
  if (answers->below(16) != 15) return &plugin;
  say(error, size);
  if (answers->below(2) == 0) throw std::runtime_error("open");
  return nullptr;
}

void* start(void* plugin, const moma_object_shape* objects, std::size_t n, char* error, std::size_t size) {
  for (std::size_t i = 0; i < n; ++i)
    if (objects[i].name == nullptr || objects[i].kind < 0) std::abort();
  if (answers->below(16) != 15) return plugin;
  say(error, size);
  if (answers->below(2) == 0) throw 7;  // no std::exception
  return nullptr;
}

std::int32_t word() {
  const std::size_t kind = answers->below(8);
  if (kind < 5) return static_cast<std::int32_t>(kind);
  return std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(answers->byte()) * 0x01010101U);
}

int step(void* /*controller*/, const moma_observation* seen, moma_step_result* result, char* error, std::size_t size) {
  if (seen->q == nullptr || seen->qdot == nullptr) std::abort();
  for (std::size_t i = 0; i < velocities; ++i) {
    const std::size_t kind = answers->below(4);
    if (kind == 3 && answers->below(8) == 0) continue;  // left out
    result->command[i] = kind == 0 ? 0.0 : fuzz::value(*answers);
  }
  switch (answers->below(12)) {
    case 0:
      result->status = word();
      break;
    case 1:
      result->fallback = word();
      break;
    case 2:
      result->slack[answers->below(6)] = fuzz::value(*answers);
      break;
    case 3:
      result->least_distance = fuzz::value(*answers);
      result->solve_seconds = fuzz::value(*answers);
      break;
    case 4:
      result->rows = result->active_rows = result->iterations = word();
      break;
    case 5:
      say(error, size);
      return 1;
    case 6:
      say(error, size);
      throw std::runtime_error("step");
    default:
      break;
  }
  return 0;
}

std::shared_ptr<const PluginLibrary> library() {
  auto made = std::make_shared<PluginLibrary>();
  made->functions = {open_plugin, [](void*) {}, start, step, [](void*) {}};
  return made;
}

bool fit_to_show(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; });
}

void check(const StepController& controller, const StepResult& result, const VectorX& limits, const char* when) {
  bool good = result.command.allFinite() && result.slack.allFinite() && !std::isnan(result.least_distance) &&
              std::isfinite(result.solve_seconds) && result.solve_seconds >= 0.0 && fit_to_show(controller.failure());
  for (Eigen::Index i = 0; good && i < limits.size(); ++i) good = std::abs(result.command[i]) <= limits[i] * (1 + 1e-9);
  good = good && to_string(result.status) != "?" && to_string(result.fallback) != "?";
  if (!controller.failure().empty()) good = good && result.command.isZero() && result.fallback == Fallback::kBrake;
  if (good) return;
  std::fprintf(stderr, "%s: status %d, fallback %d, failure '%s'\n", when, static_cast<int>(result.status),
               static_cast<int>(result.fallback), std::string(controller.failure()).c_str());
  std::abort();
}

}  // namespace
}  // namespace moma

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const auto kRobot =
      std::make_shared<const config::LoadedRobot>(config::load_robot("configs/robots/frankie.yaml"));
  static const auto kLibrary = library();
  static const VectorX kLimits = kRobot->model->velocity_limits();
  fuzz::Bytes choices(data, size);
  answers = &choices;
  try {
    const auto plugin = Plugin::open(kLibrary, kRobot, nlohmann::ordered_json::object(), 0.02);
    const auto controller = plugin->make();
    std::vector<ObjectShape> objects(choices.below(3));
    for (ObjectShape& object : objects) object.name = "o";
    controller->reset(objects);
    StepResult result;
    controller->prepare(result);
    Observation seen;
    seen.q = kRobot->model->ready;
    seen.qdot = VectorX::Zero(kLimits.size());
    seen.objects.resize(choices.below(16) == 15 ? objects.size() + 1 : objects.size());
    for (std::size_t n = 1 + choices.below(4); n > 0; --n) {
      controller->step(seen, result);
      check(*controller, result, kLimits, "step");
    }
  } catch (const PluginError& error) {
    if (!fit_to_show(error.what())) std::abort();
  }
  return 0;
}
