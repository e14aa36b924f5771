#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

namespace moma::store {

/// Held by a program that computes trials into a store, so that two runs on one store follow each other and no trial
/// is computed twice. An advisory lock (flock) on DB-lock, which the kernel releases whatever happens to its holder;
/// readers and `moma merge` do not take it. Where the file system has no such locks, nothing is held: SQLite's own
/// locks still keep the store whole.
class RunLock {
 public:
  /// Waits for another holder; `waiting` is called once, with words about who it is. Returns without the lock once
  /// `stop` is set: see held().
  RunLock(const std::filesystem::path& db, const std::atomic<bool>& stop,
          const std::function<void(const std::string&)>& waiting);
  /// Removes the file and lets the next one in.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// False where the wait was broken off.
  bool held() const { return held_; }

 private:
  bool try_lock();

  std::filesystem::path file_;
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace moma::store
