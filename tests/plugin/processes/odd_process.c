/*
 * A controller behind the protocol of docs/reference/process-protocol.md, without any library: it does what its first
 * argument says, at its third step where it says nothing else. By default it drives ahead at 0.1.
 */
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char* deed = "";

static int asked(const char* name) { return strcmp(deed, name) == 0; }

static void read_all(void* to, size_t size) {
  char* at = to;
  while (size > 0) {
    const ssize_t got = read(0, at, size);
    if (got <= 0) exit(0);
    at += got;
    size -= (size_t)got;
  }
}

static void answer(uint32_t kind, const void* payload, uint32_t size) {
  const uint32_t header[2] = {size, kind};
  if (write(1, header, sizeof header) != (ssize_t)sizeof header ||
      (size > 0 && write(1, payload, size) != (ssize_t)size))
    exit(0);
}

static void say(uint32_t kind, const char* text) { answer(kind, text, (uint32_t)strlen(text)); }

static int count(const char* text, const char* key) {
  const char* at = strstr(text, key);
  int names = 0;
  if (at == NULL) exit(9);
  for (; *at != ']'; ++at) names += *at == ',';
  return names + 1;
}

static void mark(const char* name) {
  FILE* file = fopen(name, "w");
  if (file != NULL) fclose(file);
}

static void mark_left(void) {
  char name[64];
  snprintf(name, sizeof name, "left.%ld", (long)getpid());
  mark(name);
}

/* A child of its group and one that leaves it, which would stay until they are killed; both are there before it goes
 * on. */
static void leave(void) {
  mark_left();
  for (int i = 0; i < 2; ++i) {
    int ready[2];
    char byte;
    if (pipe(ready) != 0) exit(9);
    if (fork() == 0) {
      if (i == 1) setsid();
      signal(SIGTERM, SIG_IGN);
      signal(SIGHUP, SIG_IGN);
      mark_left();
      if (write(ready[1], "x", 1) != 1) exit(9);
      for (;;) pause();
    }
    if (read(ready[0], &byte, 1) != 1) exit(9);
  }
}

int main(int argc, char** argv) {
  if (argc > 1) deed = argv[1];
  if (asked("exit_at_once")) {
    fprintf(stderr, "no licence for\tthis robot\n");
    return 3;
  }
  if (asked("hang_at_once")) pause();
  if (strncmp(deed, "leave", 5) == 0) leave();
  int velocities = 0, steps = 0;
  for (;;) {
    uint32_t header[2];
    read_all(header, sizeof header);
    char* payload = calloc(header[0] + 1, 1);
    read_all(payload, header[0]);
    if (header[1] == 1) {
      velocities = count(payload, "\"velocities\":[");
      if (asked("refuse"))
        say(104, "these parameters\nare not to my taste");
      else
        say(101, asked("other_version") ? "{\"protocol\":4711}"
                 : asked("no_json")     ? "ready"
                 : asked("own_file")    ? "{\"protocol\":6,\"files\":[\"weights.bin\"]}"
                                        : "{\"protocol\":6}");
    } else if (header[1] == 2) {
      steps = 0;
      while (asked("slow") && access("busy", F_OK) == 0) usleep(1000);
      if (asked("fail_in_reset")) say(104, "too many objects, \xff of them");  // and goes on as if nothing were
      if (asked("exit_in_reset")) return 5;
      say(102, "");
    } else {
      double command[64] = {0.1};
      uint32_t size = (uint32_t)velocities * 8;
      if (++steps == 3) {
        if (asked("exit")) return 4;
        if (asked("leave_and_hang")) {
          mark("hangs");
          for (;;) pause();
        }
        if (asked("exit_0")) return 0;
        if (asked("crash")) raise(SIGSEGV);
        if (asked("killed")) raise(SIGKILL);
        if (asked("close")) {
          close(0);
          close(1);
          pause();
        }
        if (asked("hang")) pause();
        if (asked("spin"))
          for (;;) __asm__ volatile("");
        if (asked("fail")) say(104, "lost my way");
        if (asked("print")) printf("step three\n"), fflush(stdout);
        if (asked("too_much")) size += 8;
        if (asked("short")) size -= 8;
        if (asked("endless")) size = 1u << 30;
        if (asked("nan")) command[1] = NAN;
        if (asked("status")) {
          command[velocities] = 9;
          size += 12 * 8;
        }
        if (asked("wrong_kind")) {
          say(102, "");
          free(payload);
          continue;
        }
        if (asked("memory")) {
          const size_t wanted = (size_t)10 << 30;
          char* volatile much = malloc(wanted);  // else clang leaves out all of it
          if (much == NULL) {
            say(104, "no 10 GiB to be had");
          } else {
            memset(much, 1, wanted);
          }
        }
      }
      if (asked("brake")) {
        command[velocities + 1] = 3;
        size += 12 * 8;
      }
      if (asked("flood"))
        for (int i = 0; i < 4000; ++i) fprintf(stderr, "a line of words that nobody reads\n");
      answer(103, command, size);
    }
    free(payload);
  }
}
