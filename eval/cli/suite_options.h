#pragma once

#include <CLI/CLI.hpp>
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

  /// Adds SUITE and what add_changes_to() adds.
  void add_to(CLI::App& command);
  /// Adds --set, --trials, --lenient, --seed, for a command that knows its suite.
  void add_changes_to(CLI::App& command);
  Overrides overrides() const;
  /// Throws UsageError, config::ConfigError.
  Suite load() const;
};

/// Adds --allow-plugins to a command that builds suites again from a store.
void add_allow_plugins(CLI::App& command, Plugins& plugins);

/// Adds --output of a command that evaluates into a store.
void add_output_store(CLI::App& command, fs::path& file);

/// Adds --force, for what the command writes.
void add_force(CLI::App& command, files::Replace& replace);

/// Adds --threads.
void add_threads(CLI::App& command, int& threads);

/// Adds --format.
void add_format(CLI::App& command, Format& format);

/// Adds --quiet.
void add_quiet(CLI::App& command, bool& quiet);

/// Adds DB: one store, or several where `stores` is a list.
template <class Stores>
void add_store(CLI::App& command, Stores& stores, const char* text = "Store") {
  command.add_option("DB", stores, text)->required();
}

/// Adds TRIAL, a trial of a store.
void add_trial(CLI::App& command, std::string& trial);

/// A text file that a command writes where one is named.
class OutputFile {
 public:
  /// Throws files::OutputError if the file may not be written.
  OutputFile(fs::path file, files::Kind kind, files::Replace replace);
  /// False if no file was named.
  bool wanted() const { return !file_.empty(); }
  /// Writes the file if it is wanted. Throws files::OutputError.
  void write(const std::string& text) const;

 private:
  fs::path file_;
  files::Kind kind_;
  files::Replace replace_;
};

/// Prints JSON in one line; texts that are no UTF-8 are mended.
void print_json(const Json& json);

/// Prints each warning to stderr.
void print_warnings(const std::vector<std::string>& warnings);

/// True where the file begins like an SQLite database.
bool is_database(const std::string& file);

}  // namespace moma::cli
