#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "suite_fixture.h"
#include "tests/support/process.h"

namespace moma::test {

namespace fs = std::filesystem;

/// The real program in a folder with a small robot and suites.
class CliTest : public ::testing::Test {
 protected:
  static constexpr const char* kSuite = R"(name: small
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml, slow: {include: controllers/plain.yaml, k_epsilon: 0.1}}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
trials: 6
)";

  /// Its trials stop at the gate (tests/plugin/plugins/gate_plugin.c), so that a test knows that a run is on.
  static constexpr const char* kGatedSuite = R"(name: gated
robot: robots/tiny.yaml
controllers: {gated: {method: plugin, path: gate.so}}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
trials: 300
)";

  void SetUp() override { write("suite.yaml", kSuite); }

  /// Writes gated.yaml, and closes the gate after `trials` trials of each process.
  void close_gate(int trials) const {
    write("gated.yaml", kGatedSuite);
    fs::copy_file(MOMA_BINARY_DIR "/tests/plugins/gate.so", path("gate.so"), fs::copy_options::skip_existing);
    write("gate", std::to_string(trials));
  }
  void open_gate() const { fs::remove(path("gate")); }
  /// False where the process ended before.
  bool wait_at_gate(Process& process, pid_t pid) const {
    while (!fs::exists(path("gate." + std::to_string(pid)))) {
      if (!process.running()) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }

  fs::path write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }
  fs::path path(const std::string& name) const { return folder_.root() / name; }

  std::vector<std::string> command(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), MOMA_BINARY_DIR "/moma");
    arguments.insert(arguments.begin(), starter_.begin(), starter_.end());
    return arguments;
  }
  ProcessResult moma(const std::vector<std::string>& arguments) const {
    return Process(command(arguments), folder_.root()).wait();
  }

  /// Runs, and expects success.
  ProcessResult good(const std::vector<std::string>& arguments) const {
    ProcessResult result = moma(arguments);
    EXPECT_EQ(result.code, 0) << result.out << result.err;
    return result;
  }

  /// Runs, and expects exit 2, nothing on stdout, every one of `words` on stderr, no trace of a bug, no file left.
  ProcessResult bad(const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const std::set<std::string> before = files();
    ProcessResult result = moma(arguments);
    EXPECT_EQ(result.code, 2) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
    for (const char* bug : {"internal error", "terminate", "what()", "Assertion"}) {
      EXPECT_EQ(result.err.find(bug), std::string::npos) << result.err;
    }
    EXPECT_EQ(files(), before);
    return result;
  }

  std::set<std::string> files() const {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.root())) {
      if (entry.is_regular_file() && entry.path().filename().string()[0] != '.') all.insert(entry.path().string());
    }
    return all;
  }

  std::string hash(const std::string& db) const {
    const ProcessResult result = good({"verify", db, "--fraction", "0", "--hash", "--quiet", "--allow-plugins"});
    const std::size_t at = result.out.find("results ");
    return at == std::string::npos ? "" : result.out.substr(at);
  }

  SuiteFolder folder_;
  std::vector<std::string> starter_;  ///< a program that starts moma, and its arguments
};

}  // namespace moma::test
