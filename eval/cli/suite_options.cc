#include "eval/cli/suite_options.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <iostream>

#include "eval/cli/command.h"

namespace moma::cli {

void SuiteOptions::add_to(CLI::App& command) {
  command.add_option("SUITE", file, "Suite file (YAML)")->required();
  add_changes_to(command);
}

void SuiteOptions::add_changes_to(CLI::App& command) {
  command.add_option("--set", set, "KEY=VALUE: any key of the suite, e.g. simulation.mode=kinematic; repeatable")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--trials", trials, "Number of worlds; the same as --set trials=N");
  command.add_flag_callback(
      "--lenient", [this] { set.emplace_back("robot.lenient=true"); },
      "What is not understood in the robot's URDF is left out with a warning; the same as --set "
      "robot.lenient=true");
  command.add_option("--seed", seed, "Seed of the worlds; the same as --set worlds.seed=N");
}

Overrides SuiteOptions::overrides() const {
  Overrides all;
  for (const std::string& text : set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("--set {}: needs KEY=VALUE, for instance --set simulation.mode=kinematic", text));
    }
    all.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  if (!trials.empty()) all.emplace_back("trials", trials);
  if (!seed.empty()) all.emplace_back("worlds.seed", seed);
  return all;
}

Suite SuiteOptions::load() const {
  if (is_database(file)) {
    throw UsageError(fmt::format(
        "{}: is a store, not a suite file; 'moma run {} --rerun NAME' runs a suite that is in it", file, file));
  }
  return load_suite(file, overrides());
}

void add_allow_plugins(CLI::App& command, Plugins& plugins) {
  command.add_flag_callback(
      "--allow-plugins", [&plugins] { plugins = Plugins::kOfStore; },
      "Load the plugins that the store names: code that runs here, for stores that you trust");
}

void add_output_store(CLI::App& command, fs::path& file) {
  command.add_option("-o,--output", file, "Store to write, made if missing (results/NAME.db)");
}

void add_force(CLI::App& command, files::Replace& replace) {
  command.add_flag_callback(
      "--force", [&replace] { replace = files::Replace::kAny; },
      "Replace a file that is there, also one that moma did not write; never a store");
}

OutputFile::OutputFile(fs::path file, files::Kind kind, files::Replace replace)
    : file_(std::move(file)), kind_(std::move(kind)), replace_(replace) {
  if (wanted()) files::check_replace(file_, kind_, replace_);
}

void OutputFile::write(const std::string& text) const {
  if (wanted()) files::write_file(file_, kind_, replace_, [&](std::ostream& out) { out << text; });
}

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads (all cores)")->check(CLI::Range(1, 4096));
}

void add_format(CLI::App& command, Format& format) {
  const std::map<std::string, Format> formats = {{"table", Format::kTable},
                                                 {"csv", Format::kCsv},
                                                 {"json", Format::kJson},
                                                 {"markdown", Format::kMarkdown},
                                                 {"latex", Format::kLatex}};
  command.add_option("-f,--format", format, "table, csv, json, markdown or latex")
      ->transform(CLI::Transformer(formats))
      ->check(CLI::IsMember({Format::kTable, Format::kCsv, Format::kJson, Format::kMarkdown, Format::kLatex}))
      ->option_text("table|csv|json|markdown|latex");
}

void add_quiet(CLI::App& command, bool& quiet) { command.add_flag("-q,--quiet", quiet, "No progress and no remarks"); }

void add_trial(CLI::App& command, std::string& trial) {
  command
      .add_option("TRIAL", trial, "The trial's name, or any unique beginning of it; POINT/WORLD, or the worst of POINT")
      ->required();
}

void print_json(const Json& json) { std::cout << json.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n'; }

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::cerr << "warning: " << terminal_safe(warning) << '\n';
}

bool is_database(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;  // a FIFO would block
  std::ifstream stream(file, std::ios::binary);
  char head[16] = {};
  stream.read(head, sizeof head);
  return stream.gcount() == sizeof head && std::memcmp(head, "SQLite format 3", sizeof head) == 0;
}

}  // namespace moma::cli
