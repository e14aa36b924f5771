#include <fstream>
#include <sstream>

#include "cli_fixture.h"

namespace moma {
namespace {

// `moma robot --fit-shapes` on the small robot, whose upper link has a mesh and whose slide has shapes in the file.
class CliFit : public test::CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::string stl = "solid wedge\n";
    const char* corners[] = {"0 0 0", "0.3 0 0", "0 0.1 0", "0 0 0.1"};
    for (const auto& face : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{0, 3, 2}, std::array{1, 2, 3}}) {
      stl += "facet normal 0 0 1\nouter loop\n";
      for (const int i : face) stl += std::string("vertex ") + corners[i] + "\n";
      stl += "endloop\nendfacet\n";
    }
    write("robots/wedge.stl", stl + "endsolid wedge\n");
    std::string urdf = read("robots/tiny.urdf");
    const std::string upper = R"(<link name="upper">)";
    urdf.insert(urdf.find(upper) + upper.size(),
                R"(<collision><geometry><mesh filename="wedge.stl"/></geometry></collision>)");
    write("robots/wedge.urdf", urdf);
    std::string yaml = read("robots/tiny.yaml");
    yaml.replace(yaml.find("tiny.urdf"), 9, "wedge.urdf");
    const std::size_t at = yaml.find("    - {link: upper");
    yaml.erase(at, yaml.find('\n', at) + 1 - at);
    yaml += "  from: urdf\n";
    write("robots/wedge.yaml", yaml);
  }

  std::string read(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
};

TEST_F(CliFit, PrintsABlockToPaste) {
  const test::ProcessResult result = good({"robot", "robots/wedge.yaml", "--fit-shapes"});
  EXPECT_EQ(result.out.find("# Shapes around"), 0U) << result.out;
  for (const char* word : {"wedge.stl (4 triangles)", "volume / hull", "in touch at `ready` 0, were 0"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << "\n" << result.out;
  std::string yaml = read("robots/wedge.yaml");
  write("robots/pasted.yaml", yaml.substr(0, yaml.find("collision:")) + result.out);
  const test::ProcessResult loaded = good({"robot", "robots/pasted.yaml"});
  EXPECT_EQ(loaded.out.find("hull"), std::string::npos) << loaded.out;
}

// A URDF that says what links look like, and of none what can collide.
TEST_F(CliFit, VisualMeshesAreAWayOutWhereNothingCanCollide) {
  std::string urdf = read("robots/wedge.urdf");
  for (const char* tag : {"<collision>", "</collision>"}) {
    for (std::size_t at; (at = urdf.find(tag)) != std::string::npos;)
      urdf.replace(at, std::string(tag).size(), tag[1] == '/' ? "</visual>" : "<visual>");
  }
  write("robots/seen.urdf", urdf);
  std::string yaml = read("robots/wedge.yaml");
  yaml.replace(yaml.find("wedge.urdf"), 10, "seen.urdf");
  write("robots/seen.yaml", yaml.substr(0, yaml.find("collision:")) + "collision: {from: urdf}\n");
  const test::ProcessResult refused = moma({"robot", "robots/seen.yaml"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--fit-shapes"), std::string::npos) << refused.err;
  good({"robot", "robots/seen.yaml", "--fit-shapes", "-o", "robots/fitted.yaml"});
  EXPECT_NE(read("robots/fitted.yaml").find("the URDF's visual geometry"), std::string::npos);
  EXPECT_NE(read("robots/fitted.yaml").find("link: upper"), std::string::npos);
  good({"robot", "robots/fitted.yaml"});
  good({"robot", "robots/seen.urdf", "-o", "robots/drafted.yaml"});
  EXPECT_NE(
      read("robots/drafted.yaml").find("collision: {shapes: [], from: urdf, self: auto}  # check: the URDF has no"),
      std::string::npos)
      << read("robots/drafted.yaml");
  good({"robot", "robots/seen.urdf", "--fit-shapes", "-o", "robots/whole.yaml"});
  EXPECT_NE(good({"robot", "robots/whole.yaml", "--json"}).out.find("\"link\": \"upper\""), std::string::npos);
}

TEST_F(CliFit, WritesARobotFile) {
  const test::ProcessResult result = good({"robot", "robots/wedge.yaml", "--fit-shapes", "-o", "fitted.yaml"});
  EXPECT_NE(result.err.find("wrote fitted.yaml"), std::string::npos) << result.err;
  EXPECT_EQ(result.out.find("collision:"), std::string::npos) << result.out;
  EXPECT_EQ(read("fitted.yaml").find("include: robots/wedge.yaml\n"), 0U) << read("fitted.yaml");
  const test::ProcessResult loaded = good({"robot", "fitted.yaml"});
  EXPECT_EQ(loaded.out.find("hull"), std::string::npos) << loaded.out;
  good({"robot", "robots/wedge.yaml", "--fit-shapes", "-o", "robots/again.yaml"});
  std::string first = read("fitted.yaml");
  std::string second = read("robots/again.yaml");
  EXPECT_EQ(first.substr(first.find('\n')), second.substr(second.find('\n')));  // the same in another process
}

TEST_F(CliFit, ReplacesNothingUnasked) {
  const std::string kept = "name: mine\n";
  write("fitted.yaml", kept);
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "-o", "fitted.yaml"}, {"fitted.yaml", "--force"});
  EXPECT_EQ(read("fitted.yaml"), kept);
  const std::string robot = read("robots/wedge.yaml");
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "--force", "-o", "robots/wedge.yaml"},
      {"is the robot file itself"});
  EXPECT_EQ(read("robots/wedge.yaml"), robot);
  good({"robot", "robots/wedge.yaml", "--fit-shapes", "--force", "-o", "fitted.yaml"});
  EXPECT_NE(read("fitted.yaml"), kept);
}

TEST_F(CliFit, SaysWhatIsWrong) {
  bad({"robot", "robots/tiny.yaml", "--fit-shapes"}, {"tiny.yaml:1:", "no collision geometry"});
  bad({"robot", "robots/wedge.yaml", "-o", "x.yaml"}, {"--fit-shapes"});
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "--json"}, {"--json"});
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "--max-shapes", "0"}, {"--max-shapes", "12"});
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "--shapes", "capsule,cone"}, {"cone", "sphere"});
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "-o", "robots"}, {"robots", "is a folder"});
  bad({"robot", "robots/wedge.yaml", "--fit-shapes", "-o", "nowhere/x.yaml"}, {"nowhere/x.yaml", "cannot be written"});
  std::filesystem::remove(path("robots/wedge.stl"));
  bad({"robot", "robots/wedge.yaml", "--fit-shapes"}, {"wedge.yaml:", "upper", "wedge.stl"});
}

TEST_F(CliFit, KindsAreChosen) {
  for (const std::string kind : {"sphere", "capsule", "box"}) {
    const std::string out =
        good({"robot", "robots/wedge.yaml", "--fit-shapes", "--shapes", kind, "--max-shapes", "1"}).out;
    EXPECT_NE(out.find("link: upper, shape: " + kind), std::string::npos) << out;
  }
}

// `moma robot URDF`.
using CliDraft = CliFit;

TEST_F(CliDraft, AUrdfBecomesARobotFileThatRuns) {
  const test::ProcessResult result = good({"robot", "robots/wedge.urdf", "-o", "first.yaml"});
  EXPECT_NE(result.err.find("wrote first.yaml; "), std::string::npos) << result.err;
  EXPECT_NE(read("first.yaml").find("\nurdf: robots/wedge.urdf\n"), std::string::npos) << read("first.yaml");
  good({"robot", "first.yaml"});
  write("suite.yaml",
        "name: first\nrobot: first.yaml\ncontrollers: {holistic: {}}\nworlds: {seed: 1, families: {open: "
        "{weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 1}\ntrials: 1\n");
  good({"check", "suite.yaml"});
  // Printed it is the same but for the place that the URDF is seen from.
  EXPECT_EQ(good({"robot", "robots/wedge.urdf"}).out, read("first.yaml"));
}

TEST_F(CliDraft, WithFittedShapes) {
  good({"robot", "robots/wedge.urdf", "--fit-shapes", "-o", "first.yaml"});
  EXPECT_NE(read("first.yaml").find("link: upper, shape:"), std::string::npos) << read("first.yaml");
  EXPECT_EQ(good({"robot", "first.yaml"}).out.find("hull"), std::string::npos);
}

TEST_F(CliDraft, SaysWhatIsWrong) {
  bad({"robot", "robots/wedge.urdf", "--fit-shapes"}, {"-o FILE"});
  bad({"robot", "robots/wedge.urdf", "--json"}, {"--json", "-o"});
  write("first.yaml", "name: mine\n");
  bad({"robot", "robots/wedge.urdf", "-o", "first.yaml"}, {"first.yaml", "--force"});
  EXPECT_EQ(read("first.yaml"), "name: mine\n");
  bad({"robot", "none.urdf"}, {"none.urdf"});
  write("some.urdf.xacro", "<robot name='a' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:arm/></robot>");
  bad({"robot", "some.urdf.xacro"}, {"is xacro", "xacro some.urdf.xacro > some.urdf"});
}

}  // namespace
}  // namespace moma
