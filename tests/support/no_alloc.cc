#include "tests/support/no_alloc.h"

#include <cerrno>
#include <cstddef>

#include "tests/support/sanitized.h"

#if MOMA_SANITIZED
#define MOMA_HOOK_MALLOC 0
#else
#define MOMA_HOOK_MALLOC 1
#endif

namespace {
thread_local int allocations = 0;
thread_local int until_failure = 0;  // 0: none

[[maybe_unused]] bool refused() {
  ++allocations;
  if (until_failure == 0 || --until_failure > 0) return false;
  errno = ENOMEM;
  return true;
}
}  // namespace

#if MOMA_HOOK_MALLOC
// Symbols of the program come before those of the C library, also for shared libraries. free() stays the C
// library's: what is handed out below is its own.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void*, std::size_t);         // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept { return refused() ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) noexcept { return refused() ? nullptr : __libc_calloc(count, size); }
void* realloc(void* old, std::size_t size) noexcept { return refused() ? nullptr : __libc_realloc(old, size); }
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  return refused() ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return refused() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  *out = refused() ? nullptr : __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}
#endif

namespace moma::test {

NoAlloc::NoAlloc() noexcept : start_(allocations) {}
int NoAlloc::count() const noexcept { return allocations - start_; }
bool NoAlloc::works() noexcept { return MOMA_HOOK_MALLOC != 0; }

FailingAlloc::FailingAlloc(int n) noexcept { until_failure = n; }
FailingAlloc::~FailingAlloc() { until_failure = 0; }
bool FailingAlloc::failed() const noexcept { return until_failure == 0; }

}  // namespace moma::test
