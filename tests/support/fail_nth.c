/* Preloaded into a program: makes its n-th call of one kind fail, as a full disk, a broken one or a full memory does.
     MOMA_FAIL_CALL  write (write, writev, pwrite, ftruncate on regular files: ENOSPC), fsync (fsync, fdatasync: EIO),
                     rename (EIO), read (read, pread on regular files: EIO) or malloc (malloc, calloc, realloc, aligned
   ones, from when the libraries are ready) MOMA_FAIL_AT    which call, from 1; 0: none MOMA_FAIL_ON    1: all later
   ones fail as well MOMA_FAIL_LOG   file that gets the number of calls when the program ends */
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
static int memory;     /* whether it is allocations that fail */
static long memory_at; /* MOMA_FAIL_AT, MOMA_FAIL_ON of these: getenv() would take too long for each */
static long memory_on;

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

void fail_nth_begin(void);
__attribute__((constructor)) void fail_nth_begin(void) {
  const char* wanted = getenv("MOMA_FAIL_CALL");
  memory_at = number("MOMA_FAIL_AT");
  memory_on = number("MOMA_FAIL_ON");
  memory = wanted != NULL && strcmp(wanted, "malloc") == 0;
}

static int no_memory(void) {
  if (!memory) return 0;
  const long n = atomic_fetch_add(&calls, 1) + 1;
  if (memory_at <= 0 || (n != memory_at && (n < memory_at || memory_on != 1))) return 0;
  errno = ENOMEM;
  return 1;
}

/* glibc's own, since dlsym() takes memory itself. */
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* from, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) { return no_memory() ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return no_memory() ? NULL : __libc_calloc(count, size); }
void* realloc(void* from, size_t size) { return no_memory() ? NULL : __libc_realloc(from, size); }
void* aligned_alloc(size_t alignment, size_t size) { return no_memory() ? NULL : __libc_memalign(alignment, size); }
int posix_memalign(void** out, size_t alignment, size_t size) {
  if (no_memory()) return ENOMEM;
  *out = __libc_memalign(alignment, size);
  return *out == NULL ? ENOMEM : 0;
}

#define NEXT(name) (__extension__(__typeof__(&name)) dlsym(RTLD_NEXT, #name))
#define FAIL(kind, descriptor, error)       \
  if (regular(descriptor) && fails(kind)) { \
    errno = error;                          \
    return -1;                              \
  }

ssize_t read(int descriptor, void* to, size_t size) {
  FAIL("read", descriptor, EIO)
  return NEXT(read)(descriptor, to, size);
}
ssize_t pread(int descriptor, void* to, size_t size, off_t at) {
  FAIL("read", descriptor, EIO)
  return NEXT(pread)(descriptor, to, size, at);
}
ssize_t pread64(int descriptor, void* to, size_t size, off64_t at) {
  FAIL("read", descriptor, EIO)
  return NEXT(pread64)(descriptor, to, size, at);
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
  memory = 0; /* the log takes some */
  const char* name = getenv("MOMA_FAIL_LOG");
  FILE* log = name != NULL ? fopen(name, "w") : NULL;
  if (log == NULL) return;
  unsetenv("MOMA_FAIL_CALL"); /* the log itself is written */
  fprintf(log, "%ld\n", atomic_load(&calls));
  fclose(log);
}
