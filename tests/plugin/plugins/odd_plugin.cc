// A plugin without moma's library, that does what its parameters say: {"do": "throw_in_step"} and so on; by default it
// drives ahead. ODD_ABI is the version it claims; ODD_NO_STEP leaves a function out.
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#define moma_plugin_step declared_moma_plugin_step  // this file decides itself what is exported
#include "plugin/moma_plugin.h"
#undef moma_plugin_step

#ifndef ODD_ABI
#define ODD_ABI MOMA_PLUGIN_ABI
#endif

namespace {

struct Motion {
  std::string deed;
  std::size_t velocities = 0;
  std::size_t objects = 0;
  int steps = 0;
};

bool asked(const std::string& deed, const char* name) { return deed.find('"' + std::string(name) + '"') != deed.npos; }

}  // namespace

extern "C" {

uint32_t moma_plugin_abi(void) { return ODD_ABI; }

void* moma_plugin_open(const moma_plugin_setup* setup, char* error, size_t error_size) {
  const std::string deed = setup->parameters;
  if (asked(deed, "throw_in_open")) throw std::runtime_error("no parameters today");
  if (asked(deed, "refuse")) {
    std::snprintf(error, error_size, "joint %s is not\nto my taste", setup->joints[0]);
    return nullptr;
  }
  if (asked(deed, "refuse_silently")) return nullptr;
  return new Motion{deed, setup->num_velocities};
}

void moma_plugin_close(void* plugin) { delete static_cast<Motion*>(plugin); }

void* moma_plugin_start(void* plugin, const moma_object_shape*, size_t objects, char* error, size_t error_size) {
  auto motion = std::make_unique<Motion>(*static_cast<Motion*>(plugin));
  motion->objects = objects;
  if (asked(motion->deed, "throw_in_start")) throw 3;
  if (asked(motion->deed, "fail_in_start")) {
    std::snprintf(error, error_size, "%zu objects are too many", objects);
    return nullptr;
  }
  return motion.release();
}

#ifndef ODD_NO_STEP
MOMA_PLUGIN_EXPORT int moma_plugin_step(void* controller, const moma_observation* seen, moma_step_result* result,
                                        char* error, size_t error_size) {
  Motion& m = *static_cast<Motion*>(controller);
  ++m.steps;
  for (std::size_t i = 0; i < m.velocities; ++i) result->command[i] = 0.0;
  result->command[0] = 0.1;
  if (seen->num_objects != m.objects) return 1;
  if (m.steps < 3) return 0;
  if (asked(m.deed, "throw_in_step")) throw std::logic_error("lost my way");
  if (asked(m.deed, "throw_a_number")) throw 17;
  if (asked(m.deed, "throw_out_of_memory")) throw std::bad_alloc();
  if (asked(m.deed, "fail_in_step")) {
    std::memset(error, 'x', error_size);  // not ended
    return 5;
  }
  if (asked(m.deed, "nan")) result->command[1] = std::numeric_limits<double>::quiet_NaN();
  if (asked(m.deed, "infinite")) result->command[0] = std::numeric_limits<double>::infinity();
  if (asked(m.deed, "forget")) result->command[m.velocities - 1] = std::numeric_limits<double>::signaling_NaN();
  if (asked(m.deed, "status")) result->status = 9;
  if (asked(m.deed, "fallback")) result->fallback = -1;
  if (asked(m.deed, "slack")) result->slack[2] = std::numeric_limits<double>::infinity();
  if (asked(m.deed, "brake")) result->fallback = MOMA_BRAKE;
  if (asked(m.deed, "race")) {
    for (std::size_t i = 0; i < m.velocities; ++i) result->command[i] = i % 2 == 0 ? 1e6 : -3e5;
  }
  return 0;
}
#endif

void moma_plugin_stop(void* controller) { delete static_cast<Motion*>(controller); }

}  // extern "C"
