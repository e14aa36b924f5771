#pragma once

#include <cstddef>
#include <string_view>

namespace moma::reports {

// Files that are part of the program, as reports/CMakeLists.txt lists them: the page's bundle, the queries of
// reports/sql, and what the store says of its metrics and outcomes. The function page_js() gives page.js, which lies
// between two symbols of assets.s.
#define MOMA_ASSET(name)                                                                               \
  extern "C" const char moma_asset_##name[];                                                           \
  extern "C" const char moma_asset_##name##_end[];                                                     \
  inline std::string_view name() noexcept {                                                            \
    return {moma_asset_##name, static_cast<std::size_t>(moma_asset_##name##_end - moma_asset_##name)}; \
  }
#include "reports/assets.inc"
#undef MOMA_ASSET

}  // namespace moma::reports
