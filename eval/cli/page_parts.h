#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "eval/run/replay.h"
#include "reports/render/report.h"

namespace moma::cli {

/// Options that every command with a report page has: --notes, --look, --shapes and --allow-plugins.
class PageOptions {
 public:
  void add_to(CLI::App& command);

  /// Gives the page the notes, the robots' looks, and the simulation of stored trials. This object has to outlive the
  /// page. A robot with a mesh that cannot be found or read has no look, and a line on standard error says why. Throws
  /// UsageError (--notes) and config::ConfigError (--look).
  void complete(ReportOptions& page);

 private:
  std::filesystem::path notes_;
  std::vector<std::filesystem::path> robots_;
  bool shapes_ = false;
  Plugins plugins_ = Plugins::kRefused;
  run::StoredSuites suites_;
};

}  // namespace moma::cli
