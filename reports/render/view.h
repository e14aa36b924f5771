#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "reports/render/replay_data.h"
#include "reports/render/report.h"

namespace moma::reports {

struct ViewOptions {
  int port = 8080;  ///< 0: any free one
  /// Simulates a trial whose samples the store does not hold again; empty: such trials are not played. One call at a
  /// time. Its exceptions' texts are shown in the page.
  Simulate simulate;
  std::chrono::milliseconds patience{600000};  ///< as in ReportOptions, for every answer
  TimeKnown time_known;                        ///< as in ReportOptions
  Look look;                                   ///< as in ReportOptions; asked once for each look at the store
};

/// Serves the report page of the stores on 127.0.0.1 until `stop` is set. The stores are only read, anew for every
/// answer, so that a run in progress shows. `ready` is called once with the page's address. Answers GET and HEAD of
/// /, /data.json, /state.json and /replay/TRIAL alone, and only requests addressed to this machine by name or number
/// (another site's name that resolves to 127.0.0.1 is refused); it reads no file whose name a request could choose.
/// Throws ReportError: a store that cannot be read, a port that is not free.
void serve(const Stores& stores, const ViewOptions& options, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready);

}  // namespace moma::reports
