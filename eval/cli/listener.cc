#include "eval/cli/listener.h"

#include <iostream>

#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"

namespace moma::cli {

run::Listener listener_on_stderr(bool quiet, ProgressPrinter* progress) {
  const auto say = [](const std::string& text) { std::cerr << terminal_safe_lines(text) << std::endl; };
  run::Listener listener;
  if (!quiet) listener.note = say;
  listener.notice = say;
  listener.warning = [](const std::string& text) { print_warnings({text}); };
  listener.progress = [progress](const BatchProgress& p) { progress->update(p); };
  listener.progress_end = [progress] { progress->clear(); };
  return listener;
}

}  // namespace moma::cli
