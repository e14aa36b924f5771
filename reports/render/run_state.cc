#include "reports/render/run_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

namespace moma::reports {

Writer writer_of(const std::filesystem::path& db) {
  // A run locks beside the file itself, whatever links lead to it.
  std::error_code error;
  const std::filesystem::path place = std::filesystem::canonical(db, error);
  const int file =
      open(((error ? db : place).string() + "-lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return Writer::kUnknown;
  // Shared: two readers do not take each other for a run.
  const bool free = flock(file, LOCK_SH | LOCK_NB) == 0;
  const bool held = !free && errno == EWOULDBLOCK;
  close(file);
  return free ? Writer::kGone : held ? Writer::kAtWork : Writer::kUnknown;
}

}  // namespace moma::reports
