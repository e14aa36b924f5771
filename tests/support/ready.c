/* Preloaded into a program that is called often: its libraries are loaded once, which is half of a short call. The program
   waits before its own begin (constructors, main()), and runs as a copy for each message on the socket MOMA_READY: the
   numbers of arguments and of environment variables, then the working folder and all of these, each with its zero. The
   copy is a child of the one who asks, and the answer its pid. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef int Main(int, char**, char**);
typedef void Call(void);
typedef int Start(Main*, int, char**, Call*, Call*, Call*, void*);

static void put(int descriptor, const char* file, int flags) {
  const int opened = open(file, flags, 0644);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
  close(opened);
}

Start __libc_start_main;

int __libc_start_main(Main* run, int argc, char** argv, Call* init, Call* fini, Call* end, void* stack) {
  static char text[1 << 17];
  static char* words[1 << 12];
  Start* const start = __extension__(Start*) dlsym(RTLD_NEXT, "__libc_start_main");
  const char* const socket = getenv("MOMA_READY");
  const int from = socket != NULL ? atoi(socket) : -1;
  while (from >= 0) {
    const ssize_t size = recv(from, text, sizeof text, 0);
    if (size <= 0 || size == sizeof text) _exit(0);
    const long pid = syscall(SYS_clone, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0);
    if (pid == 0) break;
    const pid_t told = (pid_t)pid;
    if (send(from, &told, sizeof told, 0) < 0) _exit(1);
  }
  if (from < 0) return start(run, argc, argv, init, fini, end, stack);
  close(from);
  int counts[2];
  memcpy(counts, text, sizeof counts);
  char* at = text + sizeof counts;
  if (counts[0] + counts[1] + 2 > (int)(sizeof words / sizeof words[0]) || chdir(at) != 0) _exit(126);
  for (int i = 0; i < counts[0] + counts[1]; ++i) words[i + (i < counts[0] ? 0 : 1)] = at += strlen(at) + 1;
  environ = words + counts[0] + 1;
  put(0, "/dev/null", O_RDONLY);
  put(1, ".stdout", O_CREAT | O_TRUNC | O_WRONLY);
  put(2, ".stderr", O_CREAT | O_TRUNC | O_WRONLY);
  Call* const begin = __extension__(Call*) dlsym(RTLD_DEFAULT, "fail_nth_begin");
  if (begin != NULL) begin();
  return start(run, counts[0], words, init, fini, end, stack);
}
