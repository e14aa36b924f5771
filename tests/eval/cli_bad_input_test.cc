#include <cerrno>
#include <cstring>

#include "cli_fixture.h"
#include "tests/support/small_disk.h"

namespace moma::test {
namespace {

class CliBadInput : public CliTest {
 protected:
  std::string text(const std::string& name) const {
    std::ifstream stream(path(name));
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// Replaces the first `from` in a file; it must be there.
  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string all = text(name);
    const std::size_t at = all.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(name, all.replace(at, from.size(), to));
  }
  /// run and check must both refuse the suite in the same words, before a store is made.
  void refused(const std::vector<std::string>& words) const {
    bad({"run", "suite.yaml", "-o", "a.db"}, words);
    bad({"check", "suite.yaml"}, words);
    EXPECT_FALSE(fs::exists(path("a.db")));
  }
};

TEST_F(CliBadInput, TheSuiteIsGoodBefore) { good({"check", "suite.yaml"}); }

TEST_F(CliBadInput, MissingSuite) { bad({"run", "nowhere.yaml"}, {"nowhere.yaml"}); }

TEST_F(CliBadInput, MissingUrdf) {
  replace("robots/tiny.yaml", "tiny.urdf", "gone.urdf");
  refused({"tiny.yaml:1:", "gone.urdf"});
  bad({"robot", "robots/tiny.yaml"}, {"tiny.yaml:1:", "gone.urdf"});
}

TEST_F(CliBadInput, BrokenUrdf) {
  const std::string whole = text("robots/tiny.urdf");
  write("robots/tiny.urdf", whole.substr(0, whole.size() / 2));
  refused({"tiny.urdf"});
  write("robots/tiny.urdf", "");
  refused({"tiny.urdf"});
  write("robots/tiny.urdf", "this is no XML");
  refused({"tiny.urdf"});
}

TEST_F(CliBadInput, GeometryThatIsNotUnderstood) {
  replace("robots/tiny.urdf", R"(<link name="root"/>)",
          R"(<link name="root"><collision><geometry><sphere radius="0,5"/></geometry></collision></link>)");
  const std::vector<std::string> words = {"tiny.yaml:1:", "tiny.urdf", "line 2: link root, collision 1",
                                          "sphere radius=\"0,5\" is not understood", "--lenient"};
  refused(words);
  bad({"robot", "robots/tiny.yaml"}, words);
  bad({"world", "suite.yaml", "0"}, words);
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"check", "suite.yaml", "--lenient", "--no-time"},
                                             {"robot", "robots/tiny.yaml", "--lenient"},
                                             {"run", "suite.yaml", "-o", "a.db", "--lenient", "-q"}}) {
    const ProcessResult result = good(command);
    if (command.back() != "-q") {
      EXPECT_NE(result.err.find("left out, since `lenient` is set"), std::string::npos) << result.err;
    }
  }
  EXPECT_NE(good({"query", "a.db", "SELECT json_extract(resolved, '$.left_out[0]') AS x FROM robot", "-f", "json"})
                .out.find("0,5"),
            std::string::npos);
  good({"verify", "a.db", "-q"});
  good({"report", "a.db", "-o", "a.html"});
  EXPECT_NE(text("a.html").find("\"left_out\":[\"line 2: link root, collision 1"), std::string::npos)
      << "the page has not what was left out";
}

TEST_F(CliBadInput, MetricsThatARunRefuses) {
  for (const std::string name : {"success", "success_rate"}) {
    write("suite.yaml", std::string(kSuite) + "metrics: {" + name + ": \"count(*)\"}\n");
    bad({"check", "suite.yaml"}, {"metrics." + name + ": is the name of moma's own rate"});
  }
  for (const char* metric :
       {"max(nothing)", "random() + count(*)", "julianday('now') + count(*)", "max(t)) FROM samples UNION SELECT (2"}) {
    write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"" + metric + "\"}\n");
    bad({"check", "suite.yaml"}, {"suite.yaml:7:17: metrics.mine: "});
  }
  write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"max(t))\"}\n");
  bad({"check", "suite.yaml"}, {"metrics.mine: near \")\": syntax error"});
  write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"1), (SELECT max(t)\"}\n");
  bad({"check", "suite.yaml"}, {"metrics.mine: its brackets do not match"});
  for (const char* metric : {"1; SELECT 2", "max(t); DROP TABLE trial", "max(t);", "max(t)); SELECT (1"}) {
    write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"" + metric + "\"}\n");
    bad({"check", "suite.yaml"}, {"suite.yaml:7:17: metrics.mine: is more than one expression: ';' ends it"});
  }
  write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"max(t) + 0 * max(';' = ';') /* ; */\"}\n");
  good({"check", "suite.yaml"});
  for (const char* metric : {"", " "}) {
    write("suite.yaml", std::string(kSuite) + "metrics: {mine: \"" + metric + "\"}\n");
    bad({"check", "suite.yaml"}, {"suite.yaml:7:17: metrics.mine: found nothing, expected an SQL expression"});
  }
}

TEST_F(CliBadInput, DamagedStores) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  fs::copy_file(path("a.db"), path("page.db"));
  {
    std::fstream file(path("page.db"), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2 * 4096);
    file.write("\0\0\0\0", 4);
  }
  const ProcessResult found = moma({"verify", "page.db"});
  EXPECT_NE(found.code, 0);
  EXPECT_NE(found.err.find("integrity: "), std::string::npos) << found.err;
  EXPECT_NE(found.err.find("Page 3"), std::string::npos) << found.err;
  fs::copy_file(path("a.db"), path("cut.db"));
  fs::resize_file(path("cut.db"), fs::file_size(path("a.db")) / 2);
  bad({"verify", "cut.db"}, {"cut.db: is damaged so far that it cannot be opened"});
  bad({"query", "cut.db", "@summary"}, {"cut.db: is damaged so far that it cannot be opened"});
}

TEST_F(CliBadInput, DeepJson) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const std::string deep = "[" + std::string(200000, '[');
  bad({"run", "a.db", "--rerun", "small", "--trials", deep.substr(0, 100000)}, {"nested more than 64 levels deep"});
  bad({"run", "suite.yaml", "-o", "b.db", "--trials", deep.substr(0, 100000)}, {"nested more than 64 levels deep"});
}

TEST_F(CliBadInput, TipIsNotALink) {
  replace("robots/tiny.yaml", "tip: slide", "tip: slyde");
  refused({"tiny.yaml:", "arm.tip", "slyde", "slide"});
}

TEST_F(CliBadInput, JointWithoutLimits) {
  replace("robots/tiny.urdf", R"(<limit lower="-1" upper="1" velocity="1.5" effort="80"/>)", "");
  refused({"tiny.yaml:", "bend", "upper", "limit"});
}

TEST_F(CliBadInput, MeshThatIsNotThere) {
  replace("robots/tiny.urdf", R"(<link name="lower">)",
          R"(<link name="lower"><collision><geometry><mesh filename="gone.stl"/></geometry></collision>)");
  replace("robots/tiny.yaml", "collision:", "collision:\n  from: urdf");
  refused({"tiny.yaml:", "gone.stl", "lower"});
  bad({"robot", "robots/tiny.yaml"}, {"tiny.yaml:", "gone.stl"});
}

TEST_F(CliBadInput, PhysicsWithoutWheels) {
  replace("robots/tiny.yaml", "  wheels: {radius: 0.1, separation: 0.4, max_speed: 20}\n", "");
  replace("suite.yaml", "mode: kinematic", "mode: dynamic");
  refused({"suite.yaml:2:", "robot: cannot be simulated in dynamic mode", "base.wheels is missing"});
}

TEST_F(CliBadInput, PhysicsWithoutMasses) {
  replace("suite.yaml", "mode: kinematic", "mode: dynamic");
  replace("robots/tiny.urdf", "<link name=\"lower\"><inertial><mass value=\"1\"/>",
          "<link name=\"lower\"><inertial><mass value=\"0\"/>");
  refused({"suite.yaml:2:", "robot: cannot be simulated in dynamic mode", "link 'lower'", "no mass", "<inertial>"});
}

TEST_F(CliBadInput, MessagesPrintNoWholeFile) {
  const std::string much = "<robot name='a'>" + std::string(200000, 'x');
  write("robots/tiny.urdf", much);
  write("robots/tiny.yaml", much);
  write("big.urdf", much);
  write("controllers/plain.yaml", "{method: rrmc, servo: " + std::string(200000, '[') + "}");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{{"robot", "robots/tiny.yaml"},
                                                                                       {"robot", "big.urdf"},
                                                                                       {"check", "suite.yaml"},
                                                                                       {"check", "robots/tiny.yaml"}}) {
    const ProcessResult done = moma(command);
    EXPECT_NE(done.code, 0);
    EXPECT_FALSE(done.err.empty());
    EXPECT_LT(done.out.size() + done.err.size(), 2000U) << command[0] << ' ' << command[1];
  }
}

TEST_F(CliBadInput, AnArmThatCannotHoldItself) {
  replace("robots/tiny.urdf", R"(<limit lower="-1" upper="1" velocity="1.5" effort="80"/>)",
          R"(<limit lower="-1" upper="1" velocity="1.5" effort="2"/>)");
  replace("suite.yaml", "mode: kinematic", "mode: dynamic");
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"check", "suite.yaml", "--no-time"}, {"robot", "robots/tiny.yaml"}}) {
    const ProcessResult done = moma(command);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_NE(
        done.err.find("joint bend: holding the arm at `ready` takes 2.943 Nm, its effort limit is 2: with physics "
                      "the arm falls"),
        std::string::npos)
        << done.err;
  }
  // At `ready` enough, with the slide out too little.
  replace("robots/tiny.urdf", R"(effort="2")", R"(effort="3.2")");
  const std::string said = good({"check", "suite.yaml", "--no-time"}).err;
  const std::size_t at = said.find("joint bend: in ");
  ASSERT_NE(at, std::string::npos) << said;
  for (const char* word : {"% of the joints' ranges holding the arm takes more than its effort limit of 3.2 Nm (up to ",
                           "at q = [", "with physics it sags there, unless arm.limits.bend.effort has the share of "})
    EXPECT_NE(said.find(word, at), std::string::npos) << word << '\n' << said;
}

// A controller that always throws is one mistake, not fifty failures.
TEST_F(CliBadInput, ControllersThatAlwaysFail) {
  fs::copy_file(MOMA_BINARY_DIR "/tests/plugins/odd.so", path("odd.so"));
  replace("suite.yaml", "controllers: {",
          "controllers: {odd: {method: plugin, path: odd.so, parameters: {do: throw_in_step}}, ");
  replace("suite.yaml", "trials: 6", "trials: 50");
  const ProcessResult stopped = moma({"run", "suite.yaml", "-o", "a.db", "--threads", "2"});
  EXPECT_EQ(stopped.code, 1) << stopped.err;
  for (const char* word :
       {"odd: all of its first 20 trials ended by the same error:", "the plugin throws: lost my way", "--keep-going"})
    EXPECT_NE(stopped.err.find(word), std::string::npos) << word << "\n" << stopped.err;
  const auto count = [&](const std::string& db) {
    return good({"query", db, "SELECT count(*) AS n FROM v_trials WHERE controller = 'odd'", "--format", "csv"}).out;
  };
  EXPECT_EQ(count("a.db"), "n\n20\n");
  good({"run", "suite.yaml", "-o", "a.db", "--keep-going"});
  EXPECT_EQ(count("a.db"), "n\n50\n");
  const ProcessResult few = moma({"run", "suite.yaml", "-o", "b.db", "--trials", "3"});
  EXPECT_EQ(few.code, 1) << few.err;
  EXPECT_NE(few.err.find("odd: all of its 3 trials ended by the same error:"), std::string::npos) << few.err;
}

TEST_F(CliBadInput, UnknownKey) {
  replace("suite.yaml", "trials: 6", "trails: 6");
  refused({"suite.yaml:6:", "trails", "trials"});
}

TEST_F(CliBadInput, WrongType) {
  replace("suite.yaml", "time_limit: 4", "time_limit: long");
  refused({"suite.yaml:5:", "simulation.time_limit", "long"});
  write("suite.yaml", kSuite);
  replace("suite.yaml", "trials: 6", "trials: [6]");
  refused({"suite.yaml:6:", "trials"});
}

TEST_F(CliBadInput, NotANumber) {
  for (const std::string value : {".nan", "nan", ".inf", "1e999"}) {
    write("suite.yaml", kSuite);
    replace("suite.yaml", "time_limit: 4", "time_limit: " + value);
    refused({"suite.yaml:5:", "simulation.time_limit"});
  }
}

TEST_F(CliBadInput, NegativeSizes) {
  replace("robots/tiny.yaml", "size: [0.04, 0.2]", "size: [-0.04, 0.2]");
  refused({"tiny.yaml:", "size", "-0.04"});
}

TEST_F(CliBadInput, EmptySuite) {
  write("suite.yaml", "");
  refused({"suite.yaml"});
  write("suite.yaml", "# nothing but a remark\n");
  refused({"suite.yaml"});
  write("suite.yaml", kSuite);
  replace("suite.yaml",
          "controllers: {plain: controllers/plain.yaml, slow: {include: controllers/plain.yaml, k_epsilon: 0.1}}",
          "controllers: {}");
  refused({"suite.yaml:3:", "controllers"});
  write("suite.yaml", kSuite);
  replace("suite.yaml", "trials: 6", "trials: 0");
  refused({"suite.yaml:6:", "trials"});
}

TEST_F(CliBadInput, NoYamlAtAll) {
  write("suite.yaml", "{name: [unclosed");
  refused({"suite.yaml:1"});
  write("suite.yaml", std::string("\x00\xff\xfe binary", 10));
  refused({"suite.yaml"});
}

TEST_F(CliBadInput, PlacesThatAreNoStore) {
  write("text.db", "this is a text file, longer than the header of a database\n");
  bad({"run", "suite.yaml", "-o", "text.db"}, {"text.db", "not an SQLite database"});
  bad({"query", "text.db", "@summary"}, {"text.db", "not an SQLite database"});
  bad({"run", "suite.yaml", "-o", "robots"}, {"robots", "is a folder"});
  bad({"run", "suite.yaml", "-o", "nowhere/a.db"}, {"nowhere", "does not exist"});
  bad({"run", "suite.yaml", "-o", "/proc/a.db"}, {"/proc/a.db"});
  bad({"run", "suite.yaml", "-o", "/dev/full"}, {"/dev/full"});
  ASSERT_EQ(Process({"/usr/bin/sqlite3", path("other.db").string(), "PRAGMA application_id=7; CREATE TABLE t (x)"},
                    folder_.root())
                .wait()
                .code,
            0);
  for (const std::string name : {"query", "verify", "replay", "report", "compare"}) {
    std::vector<std::string> arguments = {name, "other.db"};
    if (name == "query") arguments.push_back("@summary");
    if (name == "replay") arguments.push_back("00");
    if (name == "compare") arguments.insert(arguments.end(), {"a", "b"});
    bad(arguments, {"other.db", "another program"});
  }
  bad({"run", "suite.yaml", "-o", "other.db"}, {"other.db", "another program"});
}

TEST_F(CliBadInput, OutputThatCannotBeWritten) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  // The program's output into a full device: an answer that nobody got is not a success.
  const std::vector<std::string> arguments = {"/bin/sh", "-c", "exec \"$0\" query a.db @list > /dev/full",
                                              MOMA_BINARY_DIR "/moma"};
  const ProcessResult result = Process(arguments, folder_.root()).wait();
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_NE(result.err.find("could not be written"), std::string::npos) << result.err;
  bad({"report", "a.db", "-o", "/proc/a.html"}, {"/proc"});
}

TEST_F(CliBadInput, ReadOnlyFolder) {
  const SmallDisk disk(path("disk"), 4000);
  if (!disk.mounted()) GTEST_SKIP() << "mounting needs root: " << std::strerror(errno);
  good({"run", "suite.yaml", "-o", "disk/a.db", "-q"});
  ASSERT_TRUE(disk.make_read_only());
  bad({"run", "suite.yaml", "-o", "disk/b.db"}, {"disk/b.db", "cannot write in the folder"});
  bad({"run", "suite.yaml", "-o", "disk/a.db"}, {"disk/a.db", "cannot be written"});
  good({"query", "disk/a.db", "@summary"});
  good({"verify", "disk/a.db", "--fraction", "1"});
}

TEST_F(CliBadInput, FullDiskFromTheStart) {
  const SmallDisk disk(path("disk"), 48);
  if (!disk.mounted()) GTEST_SKIP() << "mounting needs root: " << std::strerror(errno);
  bad({"run", "suite.yaml", "-o", "disk/a.db"}, {"disk/a.db", "full"});
  EXPECT_TRUE(fs::is_empty(path("disk")));
}

TEST_F(CliBadInput, DiskThatFillsUpDuringTheRun) {
  const SmallDisk disk(path("disk"), 1200);
  if (!disk.mounted()) GTEST_SKIP() << "mounting needs root: " << std::strerror(errno);
  const ProcessResult result =
      moma({"run", "suite.yaml", "-o", "disk/a.db", "--trials", "400", "--set", "samples=all", "--threads", "2"});
  EXPECT_EQ(result.code, 3) << result.out << result.err;
  EXPECT_NE(result.err.find("disk is full"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("go on with: "), std::string::npos) << result.err;
  // What was saved is sound, and goes on where there is room.
  for (const std::string suffix : {"", "-wal"}) {
    if (fs::exists(path("disk/a.db" + suffix))) fs::copy_file(path("disk/a.db" + suffix), path("b.db" + suffix));
  }
  const ProcessResult verify = good({"verify", "b.db", "--fraction", "1"});
  EXPECT_NE(verify.out.find("all the same"), std::string::npos) << verify.out;
  good({"run", "suite.yaml", "-o", "b.db", "-q", "--trials", "40", "--set", "samples=all"});
  good({"verify", "b.db", "--fraction", "1"});
}

}  // namespace
}  // namespace moma::test
