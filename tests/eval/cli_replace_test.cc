#include <fstream>
#include <sstream>

#include "cli_fixture.h"

// What an output option may take the place of (files/output_file.h).
namespace moma::test {
namespace {

class CliReplace : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    good({"run", "suite.yaml", "-o", "a.db", "-q", "--trials", "1"});
  }
  std::string text(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  std::string trial() const {
    const std::string lines = good({"query", "a.db", "SELECT trial FROM v_trials LIMIT 1", "-f", "csv"}).out;
    return lines.substr(lines.find('\n') + 1, 12);
  }
  /// Refused with these words, and `name` is what it was.
  void kept(const std::string& name, const std::vector<std::string>& arguments, std::vector<std::string> words) const {
    const std::string before = text(name);
    words.push_back(name);
    bad(arguments, words);
    EXPECT_EQ(text(name), before) << name;
  }
  static std::vector<std::string> forced(std::vector<std::string> arguments) {
    arguments.emplace_back("--force");
    return arguments;
  }
};

TEST_F(CliReplace, AStoreIsReplacedByNothing) {
  fs::copy_file(path("a.db"), path("other.db"));
  fs::create_symlink("a.db", path("link.html"));
  const std::string name = trial();
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"report", "a.db", "-o", "a.db"},
                                             {"report", "a.db", "-o", "other.db"},
                                             {"report", "a.db", "-o", "link.html"},
                                             {"replay", "a.db", name, "--log", "a.db"},
                                             {"replay", "a.db", name, "--case", "other.db"},
                                             {"robot", "robots/tiny.yaml", "--fit-shapes", "-o", "other.db"}}) {
    kept(arguments.back(), arguments, {"is a store of moma's"});
    kept(arguments.back(), forced(arguments), {"is a store of moma's"});
  }
  EXPECT_EQ(text("a.db"), text("other.db"));
}

TEST_F(CliReplace, WhatMomaDidNotWriteIsReplacedWithForceAlone) {
  const std::string name = trial();
  write("notes.csv", "a,b\n1,2\n");
  write("notes.html", "<!doctype html>\n<title>mine</title>\n");
  write("notes.json", "{}\n");
  fs::create_symlink("notes.html", path("link.html"));
  for (const auto& [file, arguments] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"suite.yaml", {"report", "a.db", "-o", "suite.yaml"}},
           {"notes.html", {"report", "a.db", "-o", "notes.html"}},
           {"link.html", {"report", "a.db", "-o", "link.html"}},
           {"notes.csv", {"replay", "a.db", name, "--log", "notes.csv"}},
           {"notes.json", {"replay", "a.db", name, "--case", "notes.json"}}}) {
    kept(file, arguments, {"--force"});
  }
  good({"report", "a.db", "-o", "link.html", "--force"});
  EXPECT_NE(text("notes.html").find(" moma report</title>"), std::string::npos) << "what the link leads to";
  EXPECT_TRUE(fs::is_symlink(path("link.html")));
  good({"replay", "a.db", name, "--log", "notes.csv", "--force"});
}

TEST_F(CliReplace, WhatMomaWroteBeforeIsReplaced) {
  // All that a page of the first version and one of today have in common.
  write("a.html", "<!doctype html>\n<html lang=\"en\">\n<head>\n<title>small \xe2\x80\x93 moma report</title>\n");
  good({"report", "a.db", "-o", "a.html"});
  good({"report", "a.db", "-o", "a.html"});
  EXPECT_GT(fs::file_size(path("a.html")), 1000u);
  write("empty.html", "");
  good({"report", "a.db", "-o", "empty.html"});
  // Into a pipe, which has no path.
  const std::string piped = "'" MOMA_BINARY_DIR "/moma' replay a.db " + trial() + " --log /dev/stdout | cat > piped";
  EXPECT_EQ(Process({"/bin/sh", "-c", piped}, folder_.root()).wait().code, 0);
  EXPECT_EQ(text("piped").rfind("time_s,", 0), 0u);
}

}  // namespace
}  // namespace moma::test
