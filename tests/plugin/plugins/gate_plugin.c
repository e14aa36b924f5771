/* Stands still, and waits for a test: where the working directory has a file `gate` with a number in it, trials after so
   many wait until that file is gone. The file `gate.PID` says that one does. */
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "plugin/moma_plugin.h"

static atomic_int started;

static void wait_at_gate(int trial) {
  const struct timespec pause = {0, 1000000};
  char name[64];
  int open_for = 0;
  FILE* gate = fopen("gate", "r");
  if (gate == NULL) return;
  if (fscanf(gate, "%d", &open_for) != 1) open_for = 0;
  fclose(gate);
  if (trial <= open_for) return;
  snprintf(name, sizeof name, "gate.%ld", (long)getpid());
  gate = fopen(name, "w");
  if (gate != NULL) fclose(gate);
  while (access("gate", F_OK) == 0) nanosleep(&pause, NULL);
}

uint32_t moma_plugin_abi(void) { return MOMA_PLUGIN_ABI; }

void* moma_plugin_open(const moma_plugin_setup* setup, char* error, size_t error_size) {
  size_t* velocities = malloc(sizeof *velocities);
  (void)error;
  (void)error_size;
  if (velocities != NULL) *velocities = setup->num_velocities;
  return velocities;
}

void moma_plugin_close(void* plugin) { free(plugin); }

void* moma_plugin_start(void* plugin, const moma_object_shape* objects, size_t num_objects, char* error,
                        size_t error_size) {
  size_t* velocities = malloc(sizeof *velocities);
  (void)objects;
  (void)num_objects;
  (void)error;
  (void)error_size;
  if (velocities == NULL) return NULL;
  *velocities = *(const size_t*)plugin;
  wait_at_gate(atomic_fetch_add(&started, 1) + 1);
  return velocities;
}

int moma_plugin_step(void* controller, const moma_observation* observation, moma_step_result* result, char* error,
                     size_t error_size) {
  const size_t velocities = *(const size_t*)controller;
  size_t i;
  (void)observation;
  (void)error;
  (void)error_size;
  for (i = 0; i < velocities; ++i) result->command[i] = 0.0;
  return 0;
}

void moma_plugin_stop(void* controller) { free(controller); }
