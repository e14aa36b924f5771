#pragma once

#include "eval/cli/progress.h"
#include "eval/run/listener.h"

namespace moma::cli {

/// Texts to stderr, notes only where not `quiet`, warnings as print_warnings() does; progress to `progress`, which must
/// live as long.
run::Listener listener_on_stderr(bool quiet, ProgressPrinter* progress);

}  // namespace moma::cli
