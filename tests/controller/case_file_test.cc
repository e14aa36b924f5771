#include "controller/case/case_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "controller/case/solve.h"

namespace moma {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kCases = fs::path(MOMA_SOURCE_DIR) / "tests" / "data" / "qp_cases" / "cases";
const fs::path kRobots = kCases.parent_path() / "robots";

Json good_case() {
  std::ifstream in(kCases / "frankie_101.json");
  Json c = Json::parse(in);
  c["robot"] = (kRobots / "frankie.yaml").string();
  return c;
}

/// Writes `text` to a file beside nothing else, reads it as a case, and returns the error's message ("" for none).
class CaseFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("moma_case_") + info->name());
    fs::create_directories(folder_ / "cases");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string error_of(const std::string& text) const {
    const fs::path file = folder_ / "cases" / "case.json";
    std::ofstream(file) << text;
    try {
      read_case(file);
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "";
  }
  std::string error_of(const Json& value) const { return error_of(value.dump(1)); }

  // The case with the value at a JSON pointer replaced ("null" removes it).
  std::string error_with(const char* pointer, const Json& value) const {
    Json c = good_case();
    c[Json::json_pointer(pointer)] = value;
    return error_of(c);
  }
  std::string error_without(const char* parent, const char* key) const {
    Json c = good_case();
    c[Json::json_pointer(parent)].erase(key);
    return error_of(c);
  }

  fs::path folder_;
};

// Every word must be in the message.
void expect_words(const std::string& message, std::initializer_list<const char*> words) {
  ASSERT_FALSE(message.empty()) << "accepted without a complaint";
  for (const char* word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
}

TEST_F(CaseFile, ReadsWhatIsThere) {
  const ControlCase c = read_case(kCases / "frankie_115.json");
  const Json json = Json::parse(std::ifstream(kCases / "frankie_115.json"));
  EXPECT_EQ(c.control_period, 0.02);
  EXPECT_EQ(c.robot.model->num_velocities(), 9);
  ASSERT_EQ(c.objects.size(), json["objects"].size());
  ASSERT_EQ(c.observation.objects.size(), c.objects.size());
  for (std::size_t i = 0; i < c.objects.size(); ++i) {
    const Json& object = json["objects"][i];
    EXPECT_EQ(c.objects[i].name, object["name"]);
    EXPECT_EQ(to_string(c.objects[i].shape.kind), object["shape"].get<std::string>());
    for (std::size_t k = 0; k < object["size"].size(); ++k)
      EXPECT_EQ(c.objects[i].shape.size[static_cast<int>(k)], object["size"][k]);
    for (int k = 0; k < 6; ++k)
      EXPECT_EQ(c.observation.objects[i].V_WO_W[k], object["velocity"][static_cast<std::size_t>(k)]);
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(c.observation.base[k], json["state"]["base"][static_cast<std::size_t>(k)]);
    EXPECT_EQ(c.observation.goal.X_WG.translation()[k], json["goal"]["position"][static_cast<std::size_t>(k)]);
  }
  for (int k = 0; k < 9; ++k) EXPECT_EQ(c.observation.qdot[k], json["state"]["qdot"][static_cast<std::size_t>(k)]);
  const Json& wxyz = json["goal"]["quaternion"];
  const Eigen::Quaterniond q(wxyz[0].get<double>(), wxyz[1], wxyz[2], wxyz[3]);
  EXPECT_LT((c.observation.goal.X_WG.linear() - q.toRotationMatrix()).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_F(CaseFile, OptionalKeysHaveDefaults) {
  Json c = good_case();
  c.erase("objects");
  c.erase("control_period");
  c["goal"].erase("twist");
  c["state"].erase("qdot");
  EXPECT_EQ(error_of(c), "");
  const ControlCase read = read_case(folder_ / "cases" / "case.json");
  EXPECT_EQ(read.control_period, 0.02);
  EXPECT_TRUE(read.objects.empty());
  EXPECT_EQ(read.observation.qdot, VectorX::Zero(9));
  EXPECT_EQ(read.observation.goal.V_WG_W, Vector6::Zero());
}

TEST_F(CaseFile, AFixedBaseNeedsNoBase) {
  Json c = Json::parse(std::ifstream(kCases / "panda_001.json"));
  c["state"].erase("base");
  c["robot"] = (kRobots / "panda.yaml").string();
  EXPECT_EQ(error_of(c), "");
  expect_words(error_without("/state", "base"), {"case.json:", "state.base", "missing", "[x, y, phi]"});
}

TEST_F(CaseFile, YamlIsACaseToo) {
  EXPECT_EQ(error_of("robot: " + (kRobots / "ur5.yaml").string() +
                     "\ncontroller: {method: qp}\nstate: {q: [0, -1, 1, -1, -1, 0]}\n"
                     "goal: {position: [0.4, 0, 0.4], quaternion: [0.7071, 0, 0.7071, 0]}\n"
                     "objects:\n- {shape: capsule, size: [0.1, 0], position: [1, 1, 1]}\n"),
            "");
  const ControlCase read = read_case(folder_ / "cases" / "case.json");
  EXPECT_EQ(read.objects.at(0).name, "object0");
  const Matrix3 R = read.observation.goal.X_WG.linear();
  EXPECT_LT((R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST_F(CaseFile, TwistsOfObjectsMayBeCalledVelocities) {
  Json c = good_case();
  c["objects"][0]["velocity"] = {0, 0, 0.5, 0.1, -0.2, 0};
  EXPECT_EQ(error_of(c), "");
  const ControlCase former = read_case(folder_ / "cases" / "case.json");
  c["objects"][0]["twist"] = c["objects"][0]["velocity"];
  expect_words(error_of(c), {"objects[0].velocity", "the same as `twist`"});
  c["objects"][0].erase("velocity");
  EXPECT_EQ(error_of(c), "");
  const ControlCase read = read_case(folder_ / "cases" / "case.json");
  EXPECT_EQ(read.observation.objects[0].V_WO_W, former.observation.objects[0].V_WO_W);
  EXPECT_FALSE(read.observation.objects[0].V_WO_W.isZero());
  EXPECT_EQ(case_to_json(read), case_to_json(former));
}

TEST_F(CaseFile, MeshesAreObjectsToo) {
  Json c = good_case();
  Json& object = c["objects"][0];
  object["shape"] = "convex";
  object.erase("size");
  object["vertices"] = {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}};
  object["triangles"] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  ASSERT_EQ(error_of(c), "");
  const ControlCase read = read_case(folder_ / "cases" / "case.json");
  ASSERT_NE(read.objects[0].shape.hull, nullptr);
  EXPECT_EQ(read.objects[0].shape.hull->vertices[3], Vector3(0, 0, 0.5));
  EXPECT_EQ(case_to_json(read)["objects"][0]["triangles"], object["triangles"]);
  EXPECT_EQ(solve(read)["qdot"].size(), 9u);
  object["triangles"][2][1] = 4;
  expect_words(error_of(c), {"case.json:", "objects[0].triangles", "from 0 to 3"});
  object["vertices"].erase(0);
  expect_words(error_of(c), {"case.json:", "objects[0].vertices", "four points"});
}

TEST_F(CaseFile, MissingKeys) {
  expect_words(error_without("", "robot"), {"case.json:1:", "robot", "missing", "path of a robot file"});
  expect_words(error_without("", "controller"), {"case.json", "controller", "missing"});
  expect_words(error_without("", "state"), {"case.json", "state", "missing"});
  expect_words(error_without("", "goal"), {"case.json", "goal", "missing"});
  expect_words(error_without("/state", "q"), {"state.q", "missing", "panda_joint1", "panda_joint7"});
  expect_words(error_without("/goal", "position"), {"goal.position", "missing"});
  expect_words(error_without("/goal", "quaternion"), {"goal.quaternion", "missing", "w, x, y, z"});
  expect_words(error_without("/objects/0", "shape"), {"objects[0].shape", "missing", "sphere", "capsule"});
  expect_words(error_without("/objects/0", "size"), {"objects[0].size", "missing"});
  expect_words(error_without("/objects/0", "position"), {"objects[0].position", "missing"});
}

TEST_F(CaseFile, UnknownKeysNameTheNearest) {
  Json c = good_case();
  c["gaol"] = 1;
  expect_words(error_of(c), {"case.json:", "gaol", "goal"});
  expect_words(error_with("/state/qdott", Json::array()), {"state", "qdott", "qdot"});
  expect_words(error_with("/goal/quaternoin", Json::array()), {"goal", "quaternoin", "quaternion"});
  expect_words(error_with("/objects/0/velocty", Json::array()), {"objects[0]", "velocty", "velocity"});
  expect_words(error_with("/controller/lamda_q", 1), {"controller", "lamda_q", "lambda_q"});
}

TEST_F(CaseFile, WrongTypesAndSizes) {
  expect_words(error_of(std::string("[1, 2]")), {"case.json:1:1", "a map of keys"});
  expect_words(error_of(std::string("{\"robot\": ")), {"case.json:"});
  expect_words(error_of(std::string("")), {"case.json", "robot", "missing"});
  expect_words(error_with("/robot", 7), {"case.json", "robot"});
  expect_words(error_with("/controller", 7.5), {"case.json", "controller"});
  expect_words(error_with("/state", 3), {"state", "a map of keys"});
  expect_words(error_with("/state/q", {1, 2, 3}), {"state.q", "a list of 3", "7 numbers", "panda_joint1"});
  expect_words(error_with("/state/qdot", {1, 2}), {"state.qdot", "9 numbers", "v, omega, panda_joint1"});
  expect_words(error_with("/state/q/2", "fast"), {"state.q[2]", "'fast'", "a number"});
  expect_words(error_with("/state/base", {0, 0}), {"state.base", "a list of 2", "3 numbers"});
  expect_words(error_with("/goal/position", "here"), {"goal.position", "'here'", "3 numbers"});
  expect_words(error_with("/goal/twist", {0, 0, 0}), {"goal.twist", "6 numbers"});
  expect_words(error_with("/goal/quaternion", {1, 0, 0}), {"goal.quaternion", "4 numbers"});
  expect_words(error_with("/objects", 4), {"objects", "a list of objects"});
  expect_words(error_with("/objects/0/velocity", {0, 0, 0}), {"objects[0].velocity", "6 numbers"});
  expect_words(error_with("/objects/0/shape", "cone"), {"objects[0].shape", "cone", "sphere", "cylinder"});
  expect_words(error_with("/objects/0/size", {0.1, 0.2, 0.3, 0.4}), {"objects[0].size", "has the size"});
  expect_words(error_with("/objects/0/name", ""), {"objects[0].name", "not empty"});
  expect_words(error_with("/control_period", "soon"), {"control_period", "'soon'"});
}

TEST_F(CaseFile, NumbersOutOfRange) {
  expect_words(error_with("/control_period", 0), {"control_period", "above 0"});
  expect_words(error_with("/control_period", -1), {"control_period", "above 0"});
  expect_words(error_with("/objects/0/size/0", -0.1), {"objects[0].size[0]", "above 0"});
  expect_words(error_with("/goal/quaternion", {1, 1, 0, 0}), {"goal.quaternion", "1.414", "unit quaternion"});
  expect_words(error_with("/goal/quaternion", {0, 0, 0, 0}), {"goal.quaternion", "unit quaternion"});
  // The margin of the case, 0.1 to 0.6 rad, is less than 2.61 rad/s would cover in a second.
  expect_words(error_with("/control_period", 1), {"joint_limits.margin"});
}

TEST_F(CaseFile, NumbersThatAreNotFinite) {
  // JSON cannot say NaN; the spellings that writers use nevertheless are all refused.
  for (const char* bad :
       {"NaN", "nan", ".nan", "Infinity", "-Infinity", "inf", "-inf", "1e999", "\"inf\"", "null", "true"}) {
    Json c = good_case();
    c["state"]["q"][3] = "REPLACE";
    std::string text = c.dump(1);
    text.replace(text.find("\"REPLACE\""), 9, bad);
    expect_words(error_of(text), {"case.json:", "state.q[3]", "a number"});
  }
  for (const char* pointer : {"/state/time", "/state/base/0", "/state/q/0", "/goal/position/1", "/goal/quaternion/2",
                              "/goal/twist/3", "/objects/0/position/2", "/objects/0/quaternion/0",
                              "/objects/0/velocity/5", "/objects/0/size/0", "/control_period"}) {
    expect_words(error_with(pointer, ".nan"), {"case.json:", ".nan"});
    expect_words(error_with(pointer, ".inf"), {"case.json:", ".inf"});
  }
}

TEST_F(CaseFile, TwoObjectsOfOneName) {
  Json c = good_case();
  c["objects"].push_back(c["objects"][0]);
  expect_words(error_of(c), {"objects[1].name", "earlier object"});
}

TEST_F(CaseFile, FilesThatAreNotThere) {
  expect_words(error_with("/robot", "../robots/nobody.yaml"), {"nobody.yaml"});
  expect_words(error_with("/controller", "nothing.yaml"), {"nothing.yaml"});
  try {
    read_case(folder_ / "no_such_case.json");
    FAIL() << "read a file that is not there";
  } catch (const config::ConfigError& error) {
    expect_words(error.what(), {"no_such_case.json"});
  }
  try {
    read_case(folder_);
    FAIL() << "read a folder";
  } catch (const config::ConfigError& error) {
    expect_words(error.what(), {"moma_case_"});
  }
}

TEST_F(CaseFile, TruncatedAnywhereIsAnErrorNeverACrash) {
  const std::string text = good_case().dump(1);
  for (std::size_t length = 0; length + 1 < text.size(); length += 97) {
    EXPECT_NE(error_of(text.substr(0, length)), "") << "cut after " << length << " bytes";
  }
}

// Replaces every number of a case by extreme ones, one at a time: an error or a finite command, never anything else.
TEST_F(CaseFile, ExtremeNumbersGiveFiniteCommands) {
  const Json base = good_case();
  const Json flat = base.flatten();
  int accepted = 0;
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number()) continue;
    for (const double extreme : {0.0, 1e-320, 1e150, -1e308}) {
      Json c = base;
      c[Json::json_pointer(pointer)] = extreme;
      const std::string message = error_of(c);
      if (!message.empty()) continue;
      ++accepted;
      const ControlCase given = read_case(folder_ / "cases" / "case.json");
      const Json solved = solve(given);
      ASSERT_EQ(solved["qdot"].size(), 9u) << pointer << " = " << extreme;
      for (const Json& v : solved["qdot"])
        EXPECT_TRUE(v.is_number() && std::isfinite(v.get<double>())) << pointer << " = " << extreme << ": " << v;
      EXPECT_FALSE(explain(given).empty());
    }
  }
  EXPECT_GT(accepted, 50);
}

}  // namespace
}  // namespace moma
