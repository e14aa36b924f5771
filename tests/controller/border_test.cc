// What crosses a controller's border is one description: the numbers of it, their layout, the pages that name them.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/layout.h"
#include "controller/config/object_file.h"
#include "controller/describe/check.h"
#include "controller/describe/numbers.h"
#include "controller/step_described.h"
#include "tests/support/generated_part.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using Json = nlohmann::ordered_json;

Observation sized(int joints, int velocities, std::size_t objects) {
  Observation o;
  o.q.resize(joints);
  o.qdot.resize(velocities);
  o.objects.resize(objects);
  return o;
}

// Distinct numbers come out where the protocol's page says, and go back to the same numbers.
TEST(Border, NumbersOfAnObservationAreInTheOrderOfTheProtocol) {
  Observation o = sized(3, 5, 2);
  ASSERT_EQ(count_numbers(o), 81u + 3 + 5 + 2 * 38);
  std::vector<double> numbers(count_numbers(o));
  std::iota(numbers.begin(), numbers.end(), 1.0);
  const std::size_t first = 89, second = first + 38;
  numbers[first + 18] = 0.0;  // not visible
  for (const std::size_t truth :
       {second + 18, std::size_t{22}, std::size_t{29}, std::size_t{48}, std::size_t{55}, std::size_t{60}})
    numbers[truth] = 1.0;
  numbers[first + 19] = 0.0;  // no covariance
  numbers[second + 19] = 1.0;
  EXPECT_EQ(unpack(numbers.data(), o), numbers.data() + numbers.size());
  EXPECT_EQ(o.time, 1.0);
  EXPECT_EQ(o.base, Vector3(2, 3, 4));
  EXPECT_EQ(o.goal.X_WG.translation(), Vector3(5, 6, 7));
  EXPECT_EQ(o.goal.X_WG.linear()(0, 2), 10.0) << "by rows";
  EXPECT_EQ(o.goal.V_WG_W[5], 22.0);
  EXPECT_TRUE(o.goal.stop);
  EXPECT_EQ(o.goal.free[5], 29.0);
  ASSERT_TRUE(o.next.has_value());
  EXPECT_EQ(o.next->X_WG.translation(), Vector3(31, 32, 33));
  EXPECT_EQ(o.next->free[5], 55.0);
  ASSERT_TRUE(o.upright.has_value());
  EXPECT_EQ(o.upright->axis, Vector3(57, 58, 59));
  EXPECT_EQ(o.upright->angle, 60.0);
  ASSERT_TRUE(o.carried.has_value());
  EXPECT_EQ(o.carried->object, 62);
  EXPECT_EQ(o.carried->X_EO.translation(), Vector3(63, 64, 65));
  EXPECT_EQ(o.carried->support, 75);
  EXPECT_EQ(o.carried->touch[5], 81);
  EXPECT_EQ(o.q[0], 82.0);
  EXPECT_EQ(o.qdot[4], 89.0);
  EXPECT_EQ(o.objects[0].X_WO.translation()[0], 90.0);
  EXPECT_FALSE(o.objects[0].visible);
  EXPECT_FALSE(o.objects[0].covariance.has_value());
  EXPECT_TRUE(o.objects[1].visible);
  ASSERT_TRUE(o.objects[1].covariance.has_value());
  EXPECT_EQ(o.objects[1].covariance->velocity_W(2, 2), numbers.back());
  EXPECT_EQ(o.objects[1].covariance->position_W(0, 1), numbers[second + 21]);
  std::vector<double> again(numbers.size());
  pack(o, again.data());
  std::fill_n(numbers.begin() + first + 20, 18, 0.0);  // of a covariance that is not there
  EXPECT_EQ(again, numbers);
}

TEST(Border, PackingTakesNoMemory) {
  if (!test::NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Observation o = sized(3, 5, 4);
  std::vector<double> numbers(count_numbers(o));
  const test::NoAlloc guard;
  pack(o, numbers.data());
  unpack(numbers.data(), o);
  EXPECT_EQ(guard.count(), 0);
}

// Whatever another program answers becomes a value that a check can name.
TEST(Border, NumbersThatAreNoWordsAndNoCountsAreFound) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto wrong = [](std::size_t place, double number) {
    StepResult result;
    double details[fixed_numbers<Details>()];
    pack_part<Details>(result, details);
    details[place] = number;
    unpack_part<Details>(details, result);
    std::vector<Violation> found;
    description::Check<StepResult> check(result, {}, "", found);
    describe(check, Of<Details>{});
    return found.empty() ? std::string("nothing") : found.front().key;
  };
  for (const double bad : {-1.0, 4.0, 0.5, 1e300, -1e300, nan, inf, -inf}) {
    EXPECT_EQ(wrong(0, bad), "status") << bad;
    EXPECT_EQ(wrong(1, bad), "fallback") << bad;
  }
  EXPECT_EQ(wrong(7, nan), "slack");
  EXPECT_EQ(wrong(8, nan), "least_distance");
  EXPECT_EQ(wrong(8, inf), "nothing");
  EXPECT_EQ(wrong(9, -3.0), "rows");
  EXPECT_EQ(wrong(10, 0.5), "active_rows");
  EXPECT_EQ(wrong(11, nan), "iterations");
  EXPECT_EQ(wrong(11, 17.0), "nothing");
}

// With 100 joints and 10,000 velocities a place shows how it depends on both.
constexpr Lengths kSymbols{100, 10000};

std::string symbolic(std::size_t number) {
  const std::size_t m = number / 10000, n = number / 100 % 100, rest = number % 100;
  std::string text = rest > 0 || number == 0 ? std::to_string(rest) : "";
  for (const auto& [count, letter] : {std::pair(n, 'n'), std::pair(m, 'm')})
    if (count > 0) text += (text.empty() ? "" : " + ") + std::string(1, letter);
  return text;
}

std::string table(const Json& members, const std::string& where = "", std::size_t start = 0,
                  const std::string& first = "") {
  std::string text;
  for (const Json& member : members) {
    const std::string name = where + member["name"].get<std::string>();
    const std::size_t at = start + member["at"].get<std::size_t>();
    if (member.contains("members")) {
      if (member.contains("list"))
        text += table(member["members"], name + "[i].", 0, symbolic(at) + " + " + symbolic(member["count"]) + " i + ");
      else
        text += table(member["members"], name + ".", at);
      continue;
    }
    if (member.contains("given")) {
      const std::string what = name.substr(name.rfind('_') + 1);
      const std::string row =
          "| " + first + symbolic(member["given"]) + " | 1 | | whether there is `..._" + what + "` |\n";
      if (text.find(row) == std::string::npos) text += row;
    }
    text += "| " + first + symbolic(at) + " | " + symbolic(member["count"]) + " | `" + name + "` | ";
    if (member.contains("unit")) text += "[" + member["unit"].get<std::string>() + "] ";
    if (member.contains("truth")) text += "1 or 0; ";
    for (std::size_t i = 0; member.contains("words") && i < member["words"].size(); ++i)
      text += std::to_string(i) + " " + member["words"][i].get<std::string>() + ", ";
    text += member.value("text", "");
    text += (text.back() == ' ' ? "|\n" : " |\n");
  }
  return text;
}

TEST(BorderDocumentation, NamesTheNumbersThatThereAre) {
  const std::string head = "| at | numbers | | |\n| --- | --- | --- | --- |\n";
  const std::filesystem::path page = std::filesystem::path(MOMA_SOURCE_DIR) / "docs/reference/process-protocol.md";
  test::expect_generated(page, "numbers of a step", head + table(config::layout_of<Observation>(kSymbols)));
  test::expect_generated(page, "numbers of details", head + table(config::layout_of<StepResult, Details>(kSymbols)));
}

/// Adds the members of a struct of C with these numbers, by their place.
void add_members(const Json& members, const std::string& prefix, std::size_t start,
                 std::map<std::size_t, std::string>& lines) {
  for (const Json& member : members) {
    const std::string name = prefix + member["name"].get<std::string>();
    const std::size_t at = start + member["at"].get<std::size_t>();
    if (member.contains("given"))
      lines[start + member["given"].get<std::size_t>()] =
          "  double has_" + name.substr(name.rfind('_') + 1) + "; /**< 0: there is none, its numbers mean nothing */\n";
    if (member.contains("members") && !member.contains("list")) add_members(member["members"], name + "_", at, lines);
    const auto count = member["count"].get<std::size_t>();
    if (member.contains("members") || count >= kSymbols.joints) continue;  // lists are pointers
    std::string text = "  double " + name + (count > 1 ? "[" + std::to_string(count) + "]" : "") + ";";
    const std::string unit = member.contains("unit") ? " [" + member["unit"].get<std::string>() + "]" : "";
    std::string about = unit + (member.contains("truth") ? " 1 or 0;" : "");
    if (member.contains("text")) about += " " + member["text"].get<std::string>();
    lines[at] = text + (about.empty() ? "" : " /**<" + about + " */") + "\n";
  }
}

std::string members_of_c(const Json& members) {
  std::map<std::size_t, std::string> lines;
  add_members(members, "", 0, lines);
  std::string text;
  for (const auto& [at, line] : lines) text += line;
  return text;
}

// A layout that changes is another version of the interface.
TEST(BorderDocumentation, StructsOfCNameTheNumbersThatThereAre) {
  const std::filesystem::path header = std::filesystem::path(MOMA_SOURCE_DIR) / "plugin/moma_plugin.h";
  const auto read = [&] {
    std::ifstream in(header, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string before = read();
  const Json layout = config::layout_of<Observation>(kSymbols);
  test::expect_generated(header, "numbers of an object", members_of_c(layout.back()["members"]));
  test::expect_generated(header, "numbers of an observation", members_of_c(layout));
  std::string now = read();
  const std::regex comment(" /\\*\\*<.*\\*/");
  if (std::regex_replace(now, comment, "") == std::regex_replace(before, comment, "")) return;
  const std::string define = "#define MOMA_PLUGIN_ABI ";
  const std::size_t at = now.find(define) + define.size();
  const std::size_t digits = now.find('\n', at) - at;
  now.replace(at, digits, std::to_string(std::stoi(now.substr(at, digits)) + 1));
  std::ofstream(header, std::ios::binary) << now;
}

// A layout says where each member stands and what it is unless told otherwise.
TEST(Border, LayoutsNameEveryNumberOnce) {
  const Json layout = config::layout_of<Observation>({7, 9});
  std::vector<int> named(29 + 26 + 5 + 21 + 7 + 9 + 38, 0);
  const auto mark = [&](const auto& self, const Json& members, std::size_t start) -> void {
    for (const Json& member : members) {
      const std::size_t at = start + member["at"].get<std::size_t>();
      if (member.contains("members")) {
        self(self, member["members"], at);
        continue;
      }
      for (std::size_t i = 0; i < member["count"].get<std::size_t>(); ++i) ++named.at(at + i);
      if (member.contains("given")) named.at(start + member["given"].get<std::size_t>()) = 1;
    }
  };
  mark(mark, layout, 0);
  EXPECT_EQ(named, std::vector<int>(named.size(), 1));
  EXPECT_EQ(layout.back()["name"], "objects");
  EXPECT_EQ(config::layout_of<StepResult>({7, 9})[0]["count"], 9);
}

TEST(Border, ObjectsGoThereAndBack) {
  auto hull = std::make_shared<ConvexHull>();
  hull->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  hull->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const std::vector<ObjectShape> objects{{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}},
                                         {"pill", {ShapeKind::kCapsule, {0.1, 0.5, 0}, nullptr}},
                                         {"rock", {ShapeKind::kConvex, {0, 0, 0}, hull}}};
  const Json json = config::objects_to_json(objects);
  const auto again = config::read_objects(config::node_from_json(json, "objects"), "objects");
  EXPECT_EQ(config::objects_to_json(again), json);
  ASSERT_EQ(again.size(), 3u);
  EXPECT_EQ(again[2].shape.hull->triangles[3], Eigen::Vector3i(1, 2, 3));
  EXPECT_EQ(json[0]["kind"], json[0]["shape"]) << "the word of earlier versions";

  const auto error = [](const std::string& text) {
    try {
      config::read_objects(config::node_from_json(Json::parse(text), "objects"), "objects");
    } catch (const config::ConfigError& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(error(R"([{"kind": "sphere", "size": [1], "position": [0, 0, 0]}])"), "none");
  EXPECT_NE(error(R"([{"shape": "egg", "size": [1]}])").find("objects[0].shape: found 'egg'"), std::string::npos);
  EXPECT_NE(error(R"([{"shape": "box", "size": [1]}])").find("a box has the size: 3 numbers"), std::string::npos);
  EXPECT_NE(error(R"([{"shape": "box", "sise": [1]}])").find("size"), std::string::npos);
  EXPECT_NE(error(R"([{"shape": "convex", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
                       "triangles": [[0,1,2],[0,1,3],[0,2,3],[1,2,4]]}])")
                .find("objects[0].triangles"),
            std::string::npos);
  EXPECT_NE(error(R"([{"shape": "convex", "size": [1]}])").find("objects[0].size: a convex shape has"),
            std::string::npos);
  EXPECT_NE(error(R"({"shape": "box"})").find("expected a list of objects"), std::string::npos);
}

}  // namespace
}  // namespace moma
