#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "eval/suite/stored.h"

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

/// Prints each warning to stderr.
void print_warnings(const std::vector<std::string>& warnings);

/// True where the file begins like an SQLite database.
bool is_database(const std::string& file);

}  // namespace moma::cli
