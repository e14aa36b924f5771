/*
 * A controller in a process of its own, which holds the robot still: all of the protocol
 * (docs/reference/process-protocol.md) in C without a library. A real one reads the JSON of setup and reset, and the
 * numbers of a step.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETUP = 1, RESET = 2, STEP = 3, READY = 101, STARTED = 102, COMMAND = 103, FAILED = 104 };

static void answer(uint32_t kind, const void* payload, size_t size) {
  const uint32_t header[2] = {(uint32_t)size, kind};
  fwrite(header, sizeof header, 1, stdout);
  fwrite(payload, 1, size, stdout);
  fflush(stdout);
}

static void say(uint32_t kind, const char* text) { answer(kind, text, strlen(text)); }

/* How many names the list under this key has. */
static size_t length_of(const char* json, const char* key) {
  const char* at = strstr(json, key);
  if (at == NULL) return 0;
  size_t names = 1;
  for (; *at != '\0' && *at != ']'; ++at) names += *at == ',';
  return names;
}

int main(void) {
  double command[64] = {0.0};
  size_t velocities = 0;
  uint32_t header[2];
  while (fread(header, sizeof header, 1, stdin) == 1) {
    char* payload = malloc((size_t)header[0] + 1);
    if (payload == NULL || fread(payload, 1, header[0], stdin) != header[0]) return 1;
    payload[header[0]] = '\0';
    if (header[1] == SETUP) {
      velocities = length_of(payload, "\"velocities\":[");
      if (velocities == 0 || velocities > 64)
        say(FAILED, "a robot with 1 to 64 velocities is held");
      else
        say(READY, "{\"protocol\": 6}");
    } else if (header[1] == RESET) {
      answer(STARTED, "", 0);
    } else if (header[1] == STEP) {
      answer(COMMAND, command, velocities * sizeof(double));
    } else {
      say(FAILED, "a frame of unknown kind");
    }
    free(payload);
  }
  return 0;
}
