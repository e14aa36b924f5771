#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <exception>
#include <new>

namespace moma::store {

/// Sets the words that SQLite shows to the user, and gives the code that says so.
inline int fail(char*& words, const char* text) noexcept {
  sqlite3_free(words);
  words = sqlite3_mprintf("%s", text);
  return SQLITE_ERROR;
}

/// Runs `work`, which gives a code of SQLite; what it throws becomes a code and words, since SQLite calls from C and no
/// exception may pass through it.
template <typename Work>
int guarded(char*& words, Work&& work) noexcept {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  } catch (const std::exception& failure) {
    return fail(words, failure.what());
  }
}

/// What tables computed row by row share (https://sqlite.org/vtab.html). `Table` derives from sqlite3_vtab; `Cursor`
/// from sqlite3_vtab_cursor, with the member `std::int64_t row` and size(), the number of rows that xFilter made.
template <typename Table, typename Cursor>
struct VirtualTable {
  static Table& table(sqlite3_vtab* base) { return *static_cast<Table*>(base); }
  static Cursor& cursor(sqlite3_vtab_cursor* base) { return *static_cast<Cursor*>(base); }

  /// With everything but xCreate, xConnect, xBestIndex, xFilter and xColumn.
  static sqlite3_module module() noexcept {
    sqlite3_module module{};
    module.xDisconnect = module.xDestroy = [](sqlite3_vtab* base) {
      delete &table(base);
      return SQLITE_OK;
    };
    module.xOpen = [](sqlite3_vtab* /*table*/, sqlite3_vtab_cursor** out) {
      *out = new (std::nothrow) Cursor;
      return *out == nullptr ? SQLITE_NOMEM : SQLITE_OK;
    };
    module.xClose = [](sqlite3_vtab_cursor* base) {
      delete &cursor(base);
      return SQLITE_OK;
    };
    module.xNext = [](sqlite3_vtab_cursor* base) {
      ++cursor(base).row;
      return SQLITE_OK;
    };
    module.xEof = [](sqlite3_vtab_cursor* base) { return cursor(base).row >= cursor(base).size() ? 1 : 0; };
    module.xRowid = [](sqlite3_vtab_cursor* base, sqlite3_int64* out) {
      *out = cursor(base).row;
      return SQLITE_OK;
    };
    return module;
  }
};

}  // namespace moma::store
