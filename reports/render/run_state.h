#pragma once

#include <filesystem>

namespace moma::reports {

enum class Writer {
  kAtWork,   ///< a program that computes trials holds the store's lock
  kGone,     ///< the lock's file is there and nobody holds it: its program was killed
  kUnknown,  ///< there is no such file: nobody writes, the store was copied, or its file system has no locks
};

/// Who writes to a store, by the advisory lock on DB-lock that a run holds (store.md) and the kernel releases
/// whatever happens to its holder. Looks without waiting and holds nothing afterwards.
Writer writer_of(const std::filesystem::path& db);

}  // namespace moma::reports
