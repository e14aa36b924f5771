#include "reports/render/assets.h"

// Each asset lies between two symbols of assets.s.
#define MOMA_ASSET(name)                                                                               \
  extern "C" const char moma_asset_##name[];                                                           \
  extern "C" const char moma_asset_##name##_end[];                                                     \
  namespace moma::reports {                                                                            \
  std::string_view name() noexcept {                                                                   \
    return {moma_asset_##name, static_cast<std::size_t>(moma_asset_##name##_end - moma_asset_##name)}; \
  }                                                                                                    \
  }
#include "reports/assets.inc"
