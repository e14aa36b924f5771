#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "controller/config/paths.h"

namespace moma::store {

/// The lock of a program that writes into a store, so that two runs follow each other and compute no trial twice. It is
/// an advisory lock (flock) on DB-lock, beside the target of a symbolic link; the kernel releases it if its holder
/// dies. Readers do not take it. On a file system without such locks nothing is held; SQLite's locks still keep the
/// store consistent.
class RunLock {
 public:
  enum class Use {
    kWrite,
    kMergeFrom,  ///< prevents writing; a lock file left by a killed run stays
  };

  /// Waits for another holder, after one call of `waiting` with its description. Returns without the lock if `stop` is
  /// set: see held(). Throws StoreError if the lock's name belongs to anything but a plain file.
  RunLock(const fs::path& db, const std::atomic<bool>* stop, const std::function<void(const std::string&)>& waiting,
          Use use = Use::kWrite);
  /// Removes the file and releases the lock.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// True if a program holds the lock now; false if the file system has no locks.
  static bool taken(const fs::path& db);
  /// True if the lock's file exists, held or left by a killed program. A store with a running run but without this file
  /// is a copy that lacks the trials in DB-wal.
  static bool there(const fs::path& db);

  /// True if the lock's file was there before, held or left by a killed program.
  bool was_there() const { return was_there_; }
  /// False if the wait was stopped.
  bool held() const { return held_; }
  /// False if the file system has no locks.
  bool exclusive() const { return held_ && descriptor_ >= 0; }

 private:
  bool try_lock();
  void check_plain() const;
  void release();

  fs::path file_;
  Use use_;
  bool was_there_;
  int descriptor_ = -1;
  bool held_ = false;
  bool found_ = false;  ///< a killed program had left the file
};

}  // namespace moma::store
