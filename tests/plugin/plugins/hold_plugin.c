/* A plugin in C: turns the last joint at a constant speed, from memory of its own. */
#include <stdio.h>
#include <stdlib.h>

#include "plugin/moma_plugin.h"

struct hold {
  size_t velocities;
  double speed;
};

#ifdef HOLD_WITNESS
__attribute__((constructor)) static void tell(void) {
  FILE* witness = fopen("witness", "w");
  if (witness != NULL) fclose(witness);
}
#endif

uint32_t moma_plugin_abi(void) { return MOMA_PLUGIN_ABI; }

void* moma_plugin_open(const moma_plugin_setup* setup, char* error, size_t error_size) {
  struct hold* hold = malloc(sizeof *hold);
  (void)error;
  (void)error_size;
  if (hold == NULL) return NULL;
  hold->velocities = setup->num_velocities;
  hold->speed = 0.1 * setup->velocity_limits[setup->num_velocities - 1];
  return hold;
}

void moma_plugin_close(void* plugin) { free(plugin); }

void* moma_plugin_start(void* plugin, const moma_object_shape* objects, size_t num_objects, char* error,
                        size_t error_size) {
  struct hold* hold = malloc(sizeof *hold);
  (void)objects;
  (void)num_objects;
  (void)error;
  (void)error_size;
  if (hold != NULL) *hold = *(const struct hold*)plugin;
  return hold;
}

int moma_plugin_step(void* controller, const moma_observation* observation, moma_step_result* result, char* error,
                     size_t error_size) {
  const struct hold* hold = controller;
  size_t i;
  (void)observation;
  (void)error;
  (void)error_size;
  for (i = 0; i < hold->velocities; ++i) result->command[i] = 0.0;
  result->command[hold->velocities - 1] = hold->speed;
  return 0;
}

void moma_plugin_stop(void* controller) { free(controller); }
