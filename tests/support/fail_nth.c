/* Preloaded into a program: makes its n-th call of one kind on regular files fail, as a full disk or a broken one does.
     MOMA_FAIL_CALL  write (write, writev, pwrite, ftruncate: ENOSPC), fsync (fsync, fdatasync: EIO) or rename (EIO)
     MOMA_FAIL_AT    which call, from 1; 0: none
     MOMA_FAIL_ON    1: all later ones fail as well
     MOMA_FAIL_LOG   file that gets the number of calls when the program ends */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;

static long number(const char* name) {
  const char* text = getenv(name);
  return text != NULL ? atol(text) : 0;
}

static int fails(const char* kind) {
  const char* wanted = getenv("MOMA_FAIL_CALL");
  if (wanted == NULL || strcmp(wanted, kind) != 0) return 0;
  const long at = number("MOMA_FAIL_AT");
  const long n = atomic_fetch_add(&calls, 1) + 1;
  return at > 0 && (n == at || (n > at && number("MOMA_FAIL_ON") == 1));
}

static int regular(int descriptor) {
  struct stat found;
  return descriptor > 2 && fstat(descriptor, &found) == 0 && S_ISREG(found.st_mode);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define FAIL(kind, descriptor, error)                \
  if (regular(descriptor) && fails(kind)) {          \
    errno = error;                                   \
    return -1;                                       \
  }

ssize_t write(int descriptor, const void* from, size_t size) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(write)(descriptor, from, size);
}
ssize_t writev(int descriptor, const struct iovec* from, int count) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(writev)(descriptor, from, count);
}
ssize_t pwrite(int descriptor, const void* from, size_t size, off_t at) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(pwrite)(descriptor, from, size, at);
}
ssize_t pwrite64(int descriptor, const void* from, size_t size, off64_t at) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(pwrite64)(descriptor, from, size, at);
}
int ftruncate(int descriptor, off_t size) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(ftruncate)(descriptor, size);
}
int ftruncate64(int descriptor, off64_t size) {
  FAIL("write", descriptor, ENOSPC)
  return NEXT(ftruncate64)(descriptor, size);
}
int fsync(int descriptor) {
  if (fails("fsync")) {
    errno = EIO;
    return -1;
  }
  return NEXT(fsync)(descriptor);
}
int fdatasync(int descriptor) {
  if (fails("fsync")) {
    errno = EIO;
    return -1;
  }
  return NEXT(fdatasync)(descriptor);
}
int rename(const char* from, const char* to) {
  if (fails("rename")) {
    errno = EIO;
    return -1;
  }
  return NEXT(rename)(from, to);
}

__attribute__((destructor)) static void tell(void) {
  const char* name = getenv("MOMA_FAIL_LOG");
  FILE* log = name != NULL ? fopen(name, "w") : NULL;
  if (log == NULL) return;
  unsetenv("MOMA_FAIL_CALL"); /* the log itself is written */
  fprintf(log, "%ld\n", atomic_load(&calls));
  fclose(log);
}
