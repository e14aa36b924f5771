// What inputs may ask for at most: each limit is met just below and refused just above, by its name.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/config/mesh_hull.h"
#include "controller/config/node.h"
#include "controller/config/text_file.h"
#include "tests/support/robots.h"
#include "tests/support/scratch.h"

namespace moma {
namespace {

using config::Node;

std::string times(const std::string& text, std::size_t n) {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) all += text;
  return all;
}

template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

std::string yaml(const std::string& text) {
  return refusal([&] { config::parse_yaml(text, "t.yaml"); });
}

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST(InputBudget, OneDocument) {
  EXPECT_EQ(yaml("a: 1\n...\n"), "accepted");
  EXPECT_EQ(yaml("---\na: 1\n"), "accepted");
  EXPECT_SAYS(yaml("a: 1\n---\na: 2\n"), "t.yaml:2:1: a second document starts here");
}

TEST(InputBudget, Nesting) {
  EXPECT_EQ(yaml(times("[", 64) + times("]", 64)), "accepted");
  for (const std::string& deep :
       {times("[", 70) + times("]", 70), times("[", 400'000), times("{a: ", 100'000), times("- ", 100'000) + "a\n",
        "a: &a " + times("[", 60) + times("]", 60) + "\nb: " + times("[", 20) + "*a" + times("]", 20)})
    EXPECT_SAYS(yaml(deep), "nested more than 64 levels deep");
}

TEST(InputBudget, Aliases) {
  const Node node = config::parse_yaml("a: &a {x: [1, 2]}\nb: *a\n", "t.yaml");
  EXPECT_EQ(node.find("b")->find("x")->items.size(), 2u);
  EXPECT_EQ(node.find("b")->key_mark.line, 2);
  std::string bomb = "x0: &x0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*x" + std::to_string(i - 1);
    bomb += "x" + std::to_string(i) + ": &x" + std::to_string(i) + " [" + times(last + ",", 9) + last + "]\n";
  }
  EXPECT_SAYS(yaml(bomb), "more than 1000000 values");
  EXPECT_SAYS(yaml("a: &a [*a, *a]\n"), "the alias is inside of what it stands for");
  EXPECT_SAYS(yaml("a: &a 1\nb: [" + times("*a,", 10'001) + "]\n"), "more than 10000 aliases");
}

TEST(InputBudget, Lengths) {
  EXPECT_EQ(yaml("[" + times("1,", 200'000) + "]"), "accepted");
  EXPECT_SAYS(yaml("[" + times("1,", 200'001) + "]"), "more than 200000 entries");
  EXPECT_EQ(yaml(times("k", 1000) + ": 1\n"), "accepted");
  EXPECT_SAYS(yaml(times("k", 1001) + ": 1\n"), "a key of 1001 bytes; at most 1000");
  EXPECT_SAYS(yaml(std::string((64U << 20U) + 1, ' ')), "more than 64 MiB");
  Node root = config::parse_yaml("{}", "t.yaml");
  config::set_value(root, "a" + times(".a", 63), "1");
  EXPECT_SAYS(refusal([&] { config::set_value(root, "a" + times(".a", 200'000), "1"); }), "more than 64 parts");
}

TEST(InputBudget, Includes) {
  const test::Scratch scratch;
  for (int i = 0; i < 40; ++i) {
    const std::string next = std::to_string(i + 1) + ".yaml";
    scratch.write(std::to_string(i) + ".yaml", i < 39 ? "include: " + next + "\n" : "end: 1\n");
    scratch.write("tree" + std::to_string(i) + ".yaml",
                  i < 29 ? "a: {include: tree" + next + "}\nb: {include: tree" + next + "}\n" : "c: 1\n");
  }
  EXPECT_EQ(config::load_yaml(scratch.folder() / "10.yaml").find("end")->scalar, "1");
  const auto load = [&](const std::string& name) {
    return refusal([&] { config::load_yaml(scratch.folder() / name); });
  };
  EXPECT_SAYS(load("0.yaml"), "more than 32 files include one another in a row");
  EXPECT_SAYS(load("tree0.yaml"), "more than 1000 files are included");
  // Levels count through files.
  scratch.write("inner.yaml", "a: " + times("[", 40) + times("]", 40) + "\n");
  scratch.write("outer.yaml", times("{a: ", 40) + "{include: inner.yaml}" + times("}", 40));
  EXPECT_SAYS(load("outer.yaml"), "inner.yaml:1:");
  EXPECT_SAYS(load("outer.yaml"), "nested more than 64 levels deep");
}

TEST(InputBudget, OnlyPlainFilesAreOpened) {
  const test::Scratch scratch;
  const auto fifo = scratch.folder() / "fifo.yaml";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_SAYS(refusal([&] { config::load_yaml(fifo); }), "not a file");  // opening it would wait for a writer
  EXPECT_SAYS(refusal([&] { config::load_yaml("/dev/zero"); }), "not a file");
  scratch.write("s.yaml", "include: fifo.yaml\n");
  EXPECT_SAYS(refusal([&] { config::load_yaml(scratch.folder() / "s.yaml"); }), "s.yaml:1:10");
  EXPECT_THROW(config::read_mesh("/dev/zero", Vector3::Ones()), std::runtime_error);
}

TEST(InputBudget, AControllerThatNamesItself) {
  const test::Scratch scratch;
  const Node node = config::load_yaml(scratch.write("self.yaml", "self.yaml\n"));
  const auto model = test::load_model("configs/robots/panda.yaml");
  std::vector<std::string> warnings;
  EXPECT_SAYS(refusal([&] { config::read_controller(node, "controller", *model, 0.02, warnings); }),
              "found 'self.yaml', expected a map of parameters");
}

TEST(InputBudget, Json) {
  EXPECT_EQ(config::parse_json("{\"a\": [1, 2.5]}", "w").at("a").at(1), 2.5);
  EXPECT_NO_THROW(config::parse_json(times("[", 64) + times("]", 64), "w"));
  const auto json = [](const std::string& text) { return refusal([&] { config::parse_json(text, "world 7"); }); };
  EXPECT_SAYS(json(times("[", 65) + times("]", 65)), "world 7: nested more than 64 levels deep");
  EXPECT_SAYS(json(times("[", 400'000)), "world 7: nested more than 64 levels deep");
  EXPECT_SAYS(json(times("{\"a\":", 400'000)), "world 7: nested more than 64 levels deep");
  EXPECT_SAYS(json("[1,"), "world 7: not JSON");
}

const std::string kCollada =
    R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<unit meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source="#a" count="4"
stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 1 3 0 2 3 1 2 3</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">INSIDE<instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

class MeshInput : public testing::Test {
 protected:
  std::string read(const std::string& name, const std::string& text) {
    try {
      return std::to_string(config::read_mesh(scratch_.write(name, text), Vector3::Ones()).vertices.size());
    } catch (const std::runtime_error& e) {
      return e.what();
    }
  }
  std::string dae(const std::string& inside) {
    std::string text = kCollada;
    return read("m.dae", text.replace(text.find("INSIDE"), 6, inside));
  }
  test::Scratch scratch_;
};

// Exporters of CAD programs write millimetres; the corners are at 1 unit.
TEST_F(MeshInput, ColladaUnits) {
  const auto with = [](const std::string& unit) {
    std::string text = kCollada;
    text.replace(text.find("INSIDE"), 6, "");
    const std::string whole = "<unit meter=\"1\"/>";
    return text.replace(text.find(whole), whole.size(), unit);
  };
  for (const auto& [unit, length] : {std::pair{"<unit meter='0.001' name='mm'/>", 0.001},
                                     {"<unit name='inch' meter='0.0254'/>", 0.0254},
                                     {"<unit/>", 1.0},
                                     {"", 1.0}}) {
    const config::Mesh mesh = config::read_mesh(scratch_.write("u.dae", with(unit)), Vector3(1.0, 2.0, 1.0));
    Vector3 most = Vector3::Zero();
    for (const Vector3& p : mesh.vertices) most = most.cwiseMax(p);
    EXPECT_NEAR((most - length * Vector3(1.0, 2.0, 1.0)).norm(), 0.0, 1e-9) << unit;
  }
  for (const char* unit : {"0", "-1", "nan", "inf", "1e300", "1,0", ""})
    EXPECT_SAYS(read("u.dae", with("<unit meter='" + std::string(unit) + "'/>")), "is no length") << unit;
}

TEST_F(MeshInput, ColladaNodes) {
  EXPECT_EQ(dae(""), "4");
  EXPECT_EQ(dae(times("<node>", 100) + times("</node>", 100)), "4");
  EXPECT_SAYS(dae(times("<node>", 50'000) + times("</node>", 50'000)), "nested more than 200 deep");
  // Closed in a quoted attribute only.
  EXPECT_SAYS(dae(times("<node name='/>'>", 50'000) + times("</node>", 50'000)), "nested more than 200 deep");
  EXPECT_SAYS(dae("<instance_node url=\"#n\"/>"), "a node contains itself");
  EXPECT_SAYS(dae("<node id=\"b\"><node><instance_node url=\"#&#110;\"/></node></node>"), "a node contains itself");
  std::string bomb = "<node id=\"n0\"/>";
  for (int i = 1; i < 20; ++i) {
    bomb += "<node id=\"n" + std::to_string(i) + "\">" +
            times("<instance_node url=\"#n" + std::to_string(i - 1) + "\"/>", 10) + "</node>";
  }
  EXPECT_SAYS(dae(bomb), "more than 100000 nodes");
  std::string chain;
  for (int i = 0; i < 300; ++i)
    chain += "<node id=\"c" + std::to_string(i) + "\"><instance_node url=\"#c" + std::to_string(i + 1) + "\"/></node>";
  EXPECT_SAYS(dae(chain), "nested more than 200 deep");
}

// What the library that reads COLLADA would follow out of its data, or for ever.
TEST_F(MeshInput, ColladaNumbers) {
  const auto with = [&](const std::string& was, const std::string& is) {
    std::string text = kCollada;
    text.replace(text.find("INSIDE"), 6, "");
    return read("m.dae", text.replace(text.find(was), was.size(), is));
  };
  EXPECT_EQ(with("0 1 2 0 1 3", "0 1 2\t\n0 1 3"), "4");
  EXPECT_SAYS(with("0 1 2", "0 x 2"), "<p> is no list of whole numbers");
  EXPECT_SAYS(with("0 1 2", "0 1.5 2"), "<p> is no list of whole numbers");
  EXPECT_SAYS(with("0 1 2", "0 <!-- --> x"), "<p> is no list of whole numbers");
  EXPECT_SAYS(with("0 1 2", "<![CDATA[ x ]]>"), "<p> is no list of whole numbers");
  EXPECT_SAYS(with("0 1 2", "0 1 -5"), "<p> has a corner at the vertex -5; the first one is 0");
  const std::string normals = "offset=\"0\"/><input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/><p>";
  const auto corners = [&](const std::string& p) {
    return with("offset=\"0\"/><p>0 1 2 0 1 3 0 2 3 1 2 3", normals + p);
  };
  EXPECT_EQ(corners("0 -1 1 -1 2 -1" + times(" 0 0 1 0 3 0", 3)), "4");
  EXPECT_SAYS(corners("0 -1 1 -1 -2 -1" + times(" 0 0 1 0 3 0", 3)), "at the vertex -2");
  EXPECT_SAYS(with("stride=\"3\"", "stride=\"1\""), "more parameters (3) than its stride of 1");
  EXPECT_SAYS(with("stride=\"3\"", "stride=\"-1\""), "'stride' that is no whole number");
  EXPECT_SAYS(with("count=\"12\"", "count=\"4000000000\""), "'count' of more than the file can hold");
  EXPECT_SAYS(with("offset=\"0\"", "offset=\"4\""), "has 12 indices, no multiple of the 5");
  EXPECT_SAYS(with("VERTEX", "NORMAL"), "has no input VERTEX");
  EXPECT_SAYS(with("POSITION", "NORMAL"), "no <vertices> with an input POSITION");
  EXPECT_SAYS(with("<library_geometries>", "<library_animations><animation/></library_animations><library_geometries>"),
              "<animation> deforms or moves the mesh");
  EXPECT_SAYS(with("<triangles count=\"4\">", "<triangles count=\"4\"><vcount>3 1001</vcount>"),
              "more than 1000 corners");
}

TEST_F(MeshInput, KindsAndFaces) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  EXPECT_EQ(read("m.obj", points + "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"), "4");
  EXPECT_SAYS(read("m.obj", points + "f" + times(" 1 2 3 4", 5000) + "\n"), "a face has more than 1000 corners");
  EXPECT_SAYS(read("m.obj", points + "f" + times(" 1 2 \\\n3 4", 5000) + "\n"), "a face has more than 1000 corners");
  const std::string index = read("m.obj", points + "f 1 2 99\n");  // the reason alone, not where in which library
  EXPECT_SAYS(index, "m.obj cannot be read: OBJ: ");
  EXPECT_EQ(index.find('\n'), std::string::npos) << index;
  EXPECT_SAYS(read("m.gltf", "{}"), "expected a file that ends in .stl, .dae or .obj");
  EXPECT_SAYS(read("m", points), "expected a file that ends in .stl, .dae or .obj");
}

}  // namespace
}  // namespace moma
