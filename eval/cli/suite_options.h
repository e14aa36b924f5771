#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "eval/cli/table.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "files/output_file.h"

namespace moma::cli {

/// Options that every command with a suite has.
struct SuiteOptions {
  std::string file;
  std::vector<std::string> set;  ///< KEY=VALUE
  std::string trials;            ///< as text: checked like the file
  std::string seed;

  /// Adds SUITE, --set, --trials, --lenient, --seed.
  void add_to(CLI::App& command);
  /// The same without SUITE, for a command that knows its suite.
  void add_changes_to(CLI::App& command);
  Overrides overrides() const;
  /// Throws UsageError, config::ConfigError.
  Suite load() const;
};

/// Adds --allow-plugins to a command that builds suites again from a store.
void add_allow_plugins(CLI::App& command, Plugins& plugins);

/// Adds --output of a command that evaluates into a store.
void add_output_store(CLI::App& command, std::filesystem::path& file);

/// Adds --force, for what the command writes.
void add_force(CLI::App& command, files::Replace& replace);

/// Adds --threads.
void add_threads(CLI::App& command, int& threads);

/// Adds --format.
void add_format(CLI::App& command, Format& format);

/// Prints each warning to stderr.
void print_warnings(const std::vector<std::string>& warnings);

/// True where the file begins like an SQLite database.
bool is_database(const std::string& file);

}  // namespace moma::cli
