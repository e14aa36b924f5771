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

MOMA_ASSET(page_js)
MOMA_ASSET(page_css)
MOMA_ASSET(extent_sql)
MOMA_ASSET(trials_sql)
MOMA_ASSET(summary_sql)
MOMA_ASSET(overall_sql)
MOMA_ASSET(points_sql)
MOMA_ASSET(invocations_sql)
MOMA_ASSET(replays_sql)
MOMA_ASSET(replay_sql)
MOMA_ASSET(twin_sql)
MOMA_ASSET(evidence_sql)
MOMA_ASSET(figures_js)
MOMA_ASSET(metrics_json)
MOMA_ASSET(outcomes_json)
MOMA_ASSET(tuning_sql)
MOMA_ASSET(tuning_variables_sql)
MOMA_ASSET(tuning_evaluations_sql)
MOMA_ASSET(tuning_sensitivity_sql)
MOMA_ASSET(tuning_comparisons_sql)
