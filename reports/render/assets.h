#pragma once

#include <string_view>

namespace moma::reports {

// Files that are part of the program, as reports/CMakeLists.txt lists them: the page's bundle, the queries of
// reports/sql, and what the store says of its metrics and outcomes. The function page_js() gives page.js.
#define MOMA_ASSET(name) std::string_view name() noexcept;
#include "reports/assets.inc"
#undef MOMA_ASSET

}  // namespace moma::reports
