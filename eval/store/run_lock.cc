#include "eval/store/run_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>

#include "eval/store/machine.h"

namespace moma::store {
namespace {

constexpr std::chrono::milliseconds kPause{100};

/// What the holder wrote about itself.
std::string holder(int descriptor) {
  char text[256];
  const ssize_t n = pread(descriptor, text, sizeof text, 0);
  std::string words(text, n > 0 ? static_cast<std::size_t>(n) : 0);
  words.erase(std::find(words.begin(), words.end(), '\n'), words.end());
  return words.empty() ? "another run" : words;
}

}  // namespace

RunLock::RunLock(const std::filesystem::path& db, const std::atomic<bool>& stop,
                 const std::function<void(const std::string&)>& waiting)
    : file_(db.string() + "-lock") {
  bool told = false;
  while (!(held_ = try_lock())) {
    if (!told)
      waiting(fmt::format("{}: {} is writing to it; waiting until it is done", db.string(), holder(descriptor_)));
    told = true;
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
    if (stop.load(std::memory_order_relaxed)) return;
    std::this_thread::sleep_for(kPause);
  }
  if (descriptor_ < 0) return;
  const std::string words =
      fmt::format("another run (process {} on {}, since {})\n", getpid(), this_machine().host, utc_now());
  if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, words.data(), words.size(), 0) < 0) return;  // only words
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  if (held_) unlink(file_.c_str());  // while it is held: whoever waits finds that its file is gone, and opens anew
  close(descriptor_);
}

bool RunLock::try_lock() {
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) return true;  // no place to write: opening the store says so
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    close(descriptor_);
    unlink(file_.c_str());
    descriptor_ = -1;
    return true;
  }
  struct stat ours {};
  struct stat named {};
  const bool same = fstat(descriptor_, &ours) == 0 && stat(file_.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
                    ours.st_dev == named.st_dev;
  if (same) return true;
  close(descriptor_);  // its holder removed it meanwhile
  return try_lock();
}

}  // namespace moma::store
