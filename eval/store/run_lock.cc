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

#include "eval/store/error.h"
#include "eval/store/machine.h"
#include "files/output_file.h"

namespace moma::store {
namespace {

constexpr std::chrono::milliseconds kPause{100};

/// The holder's description of itself.
std::string holder(int descriptor) {
  char text[256];
  const ssize_t n = pread(descriptor, text, sizeof text, 0);
  std::string words(text, n > 0 ? static_cast<std::size_t>(n) : 0);
  words.erase(std::ranges::find(words, '\n'), words.end());
  return words.empty() ? "another run" : words;
}

}  // namespace

RunLock::RunLock(const fs::path& db, const std::atomic<bool>* stop,
                 const std::function<void(const std::string&)>& waiting, Use use)
    : file_(files::behind_links(db).string() + "-lock"), use_(use), was_there_(there(db)) {
  bool told = false;
  while (!(held_ = try_lock())) {
    if (!told)
      waiting(fmt::format("{}: {} is writing to it; waiting until it is done", db.string(), holder(descriptor_)));
    told = true;
    release();
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) return;
    std::this_thread::sleep_for(kPause);
  }
  if (descriptor_ < 0 || (use_ == Use::kMergeFrom && found_)) return;
  const std::string words =
      fmt::format("another {} (process {} on {}, since {})\n", use_ == Use::kWrite ? "run" : "merge", getpid(),
                  this_machine().host, utc_now());
  if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, words.data(), words.size(), 0) < 0) return;  // only words
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  // Deleted while locked: a waiting process sees that the file is gone, and opens a new one.
  if (held_ && !(use_ == Use::kMergeFrom && found_)) unlink(file_.c_str());
  release();
}

bool RunLock::taken(const fs::path& db) {
  const int file =
      open((files::behind_links(db).string() + "-lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return false;
  // Shared: two that only ask do not take each other for a run.
  const bool taken = flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(file);
  return taken;
}

bool RunLock::there(const fs::path& db) {
  struct stat found {};
  return lstat((files::behind_links(db).string() + "-lock").c_str(), &found) == 0;
}

void RunLock::release() {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

void RunLock::check_plain() const {
  struct stat found {};
  if (lstat(file_.c_str(), &found) != 0 || (S_ISREG(found.st_mode) && found.st_nlink <= 1)) return;
  throw unusable(file_, "is no plain file of its own, so that it cannot be the store's lock; remove it");
}

bool RunLock::try_lock() {
  check_plain();
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
  if (descriptor_ < 0) return true;  // no place to write: opening the store says so
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    unlink(file_.c_str());
    release();
    return true;
  }
  struct stat ours {};
  struct stat named {};
  const bool same = fstat(descriptor_, &ours) == 0 && stat(file_.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
                    ours.st_dev == named.st_dev;
  found_ = ours.st_size > 0;
  if (same) return true;
  release();  // its holder removed it meanwhile
  return try_lock();
}

}  // namespace moma::store
