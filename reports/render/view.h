#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "reports/render/report.h"

namespace moma::reports {

/// The page's options; `served` and the number of trials are the server's. `simulate` is called once at a time, and its
/// exceptions' texts are shown in the page; `patience` holds for every answer.
struct ViewOptions : ReportOptions {
  int port = 8080;  ///< 0: any free one
};

/// Serves the report page of the stores on 127.0.0.1 until `stop` is set. The stores are only read, anew for every
/// answer, so that a run in progress shows. `ready` is called once with the page's address. Answers GET and HEAD of
/// /, /data.json, /state.json and /replay/TRIAL alone, and only requests addressed to this machine by name or number
/// (another site's name that resolves to 127.0.0.1 is refused); it reads no file whose name a request could choose.
/// Throws ReportError: a store that cannot be read, a port that is not free.
void serve(const Stores& stores, const ViewOptions& options, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready);

}  // namespace moma::reports
