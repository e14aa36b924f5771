#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "eval/risk/splitting.h"
#include "eval/run/rare_event.h"

namespace moma::cli {

/// Adds --event.
void add_rare_event(CLI::App& command, std::string& event);
/// Throws UsageError, naming `command`.
run::RareEvent rare_event(const std::string& text, const std::string& command);

/// Adds --particles, --replicates, --moves, --levels and --split-seed, whose defaults are what `splitting` is.
void add_splitting(CLI::App& command, risk::SplittingOptions& splitting);

/// Adds --output of a command that keeps trials of its own.
void add_moved_trials_store(CLI::App& command, std::filesystem::path& file);

}  // namespace moma::cli
