#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

namespace moma::store {

/// Held by a program that writes into a store, so that two on one store follow each other: no trial is computed twice,
/// and what `moma merge` puts in place of a store has all that was in it. An advisory lock (flock) on DB-lock, beside
/// the file that a symbolic link leads to, which the kernel releases whatever happens to its holder; readers do not
/// take it. Where the file system has no such locks, nothing is held: SQLite's own locks still keep the store whole.
class RunLock {
 public:
  enum class Use {
    kWrite,
    kMergeFrom,  ///< nobody writes meanwhile; what a killed run left behind stays as it is
  };

  /// Waits for another holder; `waiting` is called once, with words about who it is. Returns without the lock once
  /// `stop`, where there is one, is set: see held(). Throws StoreError where something else than a plain file has the
  /// lock's name: writing there could change another file.
  RunLock(const std::filesystem::path& db, const std::atomic<bool>* stop,
          const std::function<void(const std::string&)>& waiting, Use use = Use::kWrite);
  /// Removes the file and lets the next one in.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// True if a program holds the store's lock now; false also on a file system without locks.
  static bool taken(const std::filesystem::path& db);
  /// Whether the lock's file is there, held or left behind by a program that was killed. A store that says of a run
  /// that it goes on, and has none, is a copy: it lacks what that run had in DB-wal.
  static bool there(const std::filesystem::path& db);

  /// False where the wait was broken off.
  bool held() const { return held_; }
  /// False where the file system has no locks.
  bool exclusive() const { return held_ && descriptor_ >= 0; }

 private:
  bool try_lock();
  void check_plain() const;
  void release();

  std::filesystem::path file_;
  Use use_;
  int descriptor_ = -1;
  bool held_ = false;
  bool found_ = false;  ///< the file had been left behind
};

}  // namespace moma::store
