// Descriptions: what the strict reader, the writer, the range check, the list of keys and the comparison make of one.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>

#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "controller/describe/check.h"
#include "controller/describe/equal.h"
#include "controller/describe/keys.h"

namespace moma::sample {
namespace {

enum class Taste { kSweet, kSour, kSalty };
constexpr auto words(Of<Taste>) { return std::to_array<std::string_view>({"sweet", "sour", "salty"}); }

struct Either {
  bool automatic = true;
  double value = 0.5;
};
constexpr auto alternative(Of<Either>) { return WordOr{"auto", &Either::automatic, &Either::value}; }

struct Aim {
  bool ready = true;
  Eigen::VectorXd value;
};
constexpr auto alternative(Of<Aim>) { return WordOr{"ready", &Aim::ready, &Aim::value}; }

struct Part {
  bool enabled = false;
  double gain = 2.0;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Part>) {
  v.member("gain", &Part::gain, positive("1/s", "how strongly"));
}

struct Common {
  double width = 1.0;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Common>) {
  v.member("width", &Common::width, {.unit = "m", .range = Range::positive_or_inf()});
}

struct Mode {
  bool on = true;
  int level = 3;
};
bool from_word(std::string_view word, Mode& mode) {
  if (word != "off") return false;
  mode.on = false;
  return true;
}
template <class Visitor>
constexpr void describe(Visitor& v, Of<Mode>) {
  v.member("on", &Mode::on, {});
  v.member("level", &Mode::level, {.range = {0, 5}});
}

// A type of its own: "3 apples".
struct Apples {
  int count = 1;
  bool operator==(const Apples&) const = default;
};
void read_value(const config::Node& node, const std::string& key, Apples& value, const About&) {
  const std::string text = config::read_string(node, key);
  if (text.find(" apples") == std::string::npos)
    config::fail(node.mark, key, "found '" + text + "', expected N apples");
  value.count = std::stoi(text);
}
nlohmann::ordered_json write_value(const Apples& value, const About&) {
  return std::to_string(value.count) + " apples";
}
std::string accepted(Of<Apples>, const About&) { return "N apples"; }
std::string text_of(const Apples& value) { return std::to_string(value.count) + " apples"; }

struct Whole {
  std::string name = "plain";
  double speed = 0.25;
  bool loud = false;
  long long count = 7;
  unsigned long long seed = 1;
  Taste taste = Taste::kSour;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 1> limit = Eigen::Matrix<double, 6, 1>::Constant(10.0);
  Eigen::VectorXd joints = Eigen::VectorXd::Constant(2, 0.1);
  std::vector<double> waypoints;
  std::vector<Part> parts;
  std::optional<double> height;
  Either margin;
  Aim target;
  Part none, omitted, kept;
  Common common;
  Mode mode;
  double deep = 4.0;
  int late = 0;
  Part late_part;
  Apples apples;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Whole>) {
  v.member("name", &Whole::name, {.text = "what it is called"});
  v.member("speed", &Whole::speed, {.unit = "m/s", .range = {0, 1, false, true}});
  v.member("loud", &Whole::loud, {});
  v.member("count", &Whole::count, {.range = {-10, 10}});
  v.member("seed", &Whole::seed, {});
  v.member("taste", &Whole::taste, {});
  v.inlined(&Whole::common);
  v.member("place", &Whole::place, {.unit = "m"});
  v.member("limit", &Whole::limit, {.range = Range::positive_or_inf(), .one_for_all = true});
  v.member("joints", &Whole::joints, {.range = Range::non_negative(), .per = Per::kJoint, .one_for_all = true});
  v.member("waypoints", &Whole::waypoints, {});
  v.member("parts", &Whole::parts, {});
  v.member("height", &Whole::height, {.range = Range::positive()});
  v.member("margin", &Whole::margin, {.range = Range::positive()});
  v.member("target", &Whole::target, {.per = Per::kJoint});
  v.optional("none", &Whole::none, &Part::enabled, Off::kNone, "a part");
  v.optional("omitted", &Whole::omitted, &Part::enabled, Off::kOmitted, "a part");
  v.optional("kept", &Whole::kept, &Part::enabled, Off::kKept, "a part");
  v.member("mode", &Whole::mode, {});
  v.group("nested", "a group", [](auto& g) { g.member("deep", &Whole::deep, {.unit = "m"}); });
  v.member("late", &Whole::late, {.written = Written::kUnlessDefault});
  v.group("later", "written where something in it is",
          [](auto& g) { g.optional("part", &Whole::late_part, &Part::enabled, Off::kOmitted, "a part"); });
  v.member("apples", &Whole::apples, {});
}

struct Needs {
  double mass = 0.0;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Needs>) {
  v.member("mass", &Needs::mass, {.unit = "kg", .range = Range::positive(), .required = true});
}

const Lengths kTwoJoints{2, 5};

Whole read(const std::string& text) {
  Whole value;
  config::read_described(config::parse_yaml(text, "w.yaml"), "whole", value, kTwoJoints);
  return value;
}

std::string error(const std::string& text) {
  try {
    read(text);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "no error";
}

Whole everything() {
  Whole w;
  w.name = "1.5";  // a text that looks like a number
  w.speed = 1.0 / 3;
  w.loud = true;
  w.count = -10;
  w.seed = 9223372036854775807ULL;
  w.taste = Taste::kSalty;
  w.place << 1e-300, -0.0, 3;
  w.limit[2] = std::numeric_limits<double>::infinity();
  w.joints << 0.1, 0.2;
  w.waypoints = {1, 2, 3};
  w.parts = {{false, 0.1}, {false, 0.2}};
  w.height = 2.5;
  w.margin = {false, 0.7};
  w.target = {false, Eigen::Vector2d(-1, 1)};
  w.none = w.omitted = w.late_part = {true, 1.0 / 7};
  w.kept = {false, 1.0 / 9};
  w.common.width = std::numeric_limits<double>::infinity();
  w.mode = {false, 5};
  w.deep = -7;
  w.late = 3;
  w.apples.count = 12;
  return w;
}

TEST(Describe, DefaultsAreWrittenInOrderAndLeaveOutWhatIsSaidToBe) {
  EXPECT_EQ(config::write_described(Whole{}).dump(),
            R"({"name":"plain","speed":0.25,"loud":false,"count":7,"seed":1,"taste":"sour","width":1.0,)"
            R"("place":[0.0,0.0,0.0],"limit":10.0,"joints":0.1,"waypoints":[],"parts":[],"margin":"auto",)"
            R"("target":"ready","none":"none","kept":{"enabled":false,"gain":2.0},"mode":{"on":true,"level":3},)"
            R"("nested":{"deep":4.0},"apples":"1 apples"})");
}

TEST(Describe, WhatIsWrittenIsReadToTheSameBits) {
  const Whole w = everything();
  const nlohmann::ordered_json json = config::write_described(w);
  for (const bool through_text : {false, true}) {
    Whole back;
    const config::Node node =
        through_text ? config::parse_yaml(json.dump(), "w.json") : config::node_from_json(json, "store");
    config::read_described(node, "", back, kTwoJoints);
    EXPECT_EQ(config::write_described(back).dump(), json.dump());
    EXPECT_TRUE(same(back, w));
    EXPECT_TRUE(std::signbit(back.place[1]));
  }
  // Each member that is forgotten by the writer or the reader would come back as its default: none of them is.
  EXPECT_EQ(json.size(), config::write_described(Whole{}).size() + 4) << json.dump();
}

TEST(Describe, APartThatIsOffKeepsItsValuesWhereTheFileHasThem) {
  const Whole w = read("kept: {enabled: false, gain: 5}\nnone: {enabled: false, gain: 6}\nomitted: {gain: 7}\n");
  EXPECT_FALSE(w.kept.enabled);
  EXPECT_EQ(w.kept.gain, 5);
  EXPECT_FALSE(w.none.enabled);
  EXPECT_EQ(w.none.gain, 6);
  EXPECT_TRUE(w.omitted.enabled);
  EXPECT_EQ(read(config::write_described(w).dump()).kept.gain, 5);
  EXPECT_EQ(read(config::write_described(w).dump()).none.gain, 2);  // the word none carries nothing
}

TEST(Describe, ReadsEveryShortForm) {
  const Whole w = read("limit: .inf\njoints: 3\nmode: off\nmargin: 0.25\nkept: none\ntarget: [1, 2]\n");
  EXPECT_EQ(w.limit[5], std::numeric_limits<double>::infinity());
  EXPECT_EQ(w.joints, Eigen::Vector2d(3, 3));
  EXPECT_FALSE(w.mode.on);
  EXPECT_EQ(w.mode.level, 3);
  EXPECT_FALSE(w.margin.automatic);
  EXPECT_EQ(w.margin.value, 0.25);
  EXPECT_FALSE(w.kept.enabled);
  EXPECT_FALSE(w.target.ready);
}

TEST(Describe, MistakesAreNamedWithTheirPlaceAndWhatIsAccepted) {
  EXPECT_EQ(error("sped: 1"), "w.yaml:1:1: whole.sped: unknown key (did you mean speed?)");
  EXPECT_EQ(error("name: x\nspeed: 1"), "w.yaml:2:8: whole.speed: found '1', expected a number from 0 to 1, below 1");
  EXPECT_EQ(error("none: {gain: 0}"), "w.yaml:1:14: whole.none.gain: found '0', expected a number above 0");
  EXPECT_EQ(error("none: {gian: 1}"), "w.yaml:1:8: whole.none.gian: unknown key (did you mean gain?)");
  EXPECT_EQ(error("omitted: on"), "w.yaml:1:10: whole.omitted: found 'on', expected a map of keys");
  EXPECT_EQ(error("taste: bitter"), "w.yaml:1:8: whole.taste: found 'bitter', expected one of: sweet, sour, salty");
  EXPECT_EQ(error("taste: salt"),
            "w.yaml:1:8: whole.taste: found 'salt', expected one of: sweet, sour, salty (did you mean salty?)");
  EXPECT_EQ(error("count: 11"), "w.yaml:1:8: whole.count: found '11', expected a whole number from -10 to 10");
  EXPECT_EQ(error("seed: -1"),
            "w.yaml:1:7: whole.seed: found '-1', expected a whole number from 0 to 9223372036854775807");
  EXPECT_EQ(error("place: [1, 2]"), "w.yaml:1:8: whole.place: found a list of 2, expected a list of 3 numbers");
  EXPECT_EQ(error("place: 1"), "w.yaml:1:8: whole.place: found '1', expected a list of 3 numbers");
  EXPECT_EQ(error("joints: [1, -2]"), "w.yaml:1:13: whole.joints[1]: found '-2', expected a number of at least 0");
  EXPECT_EQ(error("parts: [{gain: 1}, {gain: -1}]"),
            "w.yaml:1:27: whole.parts[1].gain: found '-1', expected a number above 0");
  EXPECT_EQ(error("margin: much"), "w.yaml:1:9: whole.margin: found 'much', expected auto or a number above 0");
  EXPECT_EQ(error("margin: -1"), "w.yaml:1:9: whole.margin: found '-1', expected a number above 0");
  EXPECT_EQ(error("target: home"), "w.yaml:1:9: whole.target: found 'home', expected ready or a list of 2 numbers");
  EXPECT_EQ(error("mode: on"), "w.yaml:1:7: whole.mode: found 'on', expected a map of keys");
  EXPECT_EQ(error("apples: pears"), "w.yaml:1:9: whole.apples: found 'pears', expected N apples");
  EXPECT_EQ(error("nested: {deeper: 1}"), "w.yaml:1:10: whole.nested.deeper: unknown key (did you mean deep?)");
  EXPECT_EQ(error("{}"), "no error");
  Needs needs;
  try {
    config::read_described(config::parse_yaml("{}", "n.yaml"), "body", needs);
    ADD_FAILURE() << "a required member may be missing";
  } catch (const config::ConfigError& e) {
    EXPECT_STREQ(e.what(), "n.yaml:1:1: body.mass: missing; expected a number above 0");
  }
}

TEST(Describe, ValuesThatCodeHasFilledAreCheckedAlike) {
  EXPECT_TRUE(violations(everything(), kTwoJoints).empty());
  Whole w = everything();
  w.speed = 1.0;
  w.count = 11;
  w.taste = static_cast<Taste>(9);
  w.common.width = 0.0;
  w.joints = Eigen::Vector3d(1, 2, 3);
  w.limit[3] = std::numeric_limits<double>::quiet_NaN();
  w.kept.gain = -1;
  w.margin.value = 0.0;
  w.parts[1].gain = 0;
  w.deep = std::numeric_limits<double>::infinity();
  std::string all;
  for (const Violation& v : violations(w, kTwoJoints)) all += v.key + " " + v.message + "\n";
  EXPECT_EQ(all,
            "speed must be a finite number from 0 to 1, below 1, is 1\n"
            "count must be a whole number from -10 to 10, is 11\n"
            "taste must be one of: sweet, sour, salty\n"
            "width must be above 0 or infinite, is 0\n"
            "limit must be above 0 or infinite, is nan\n"
            "joints has 3 values, the robot has 2 joints\n"
            "parts[1].gain must be a finite number above 0, is 0\n"
            "margin must be a finite number above 0, is 0\n"
            "kept.gain must be a finite number above 0, is -1\n"
            "nested.deep must be a finite number, is inf\n");
}

TEST(Describe, KeysAreListedWithUnitRangeDefaultAndText) {
  std::string all;
  for (const Key& key : keys_of<Whole>())
    all += key.name + " | " + key.unit + " | " + key.accepted + " | " + key.otherwise + " | " + key.text + "\n";
  EXPECT_EQ(all,
            "name |  | text | plain | what it is called\n"
            "speed | m/s | a number from 0 to 1, below 1 | 0.25 | \n"
            "loud |  | true or false | false | \n"
            "count |  | a whole number from -10 to 10 | 7 | \n"
            "seed |  | a whole number from 0 to 9223372036854775807 | 1 | \n"
            "taste |  | one of: sweet, sour, salty | sour | \n"
            "width | m | a number above 0, or .inf | 1 | \n"
            "place | m | a list of 3 numbers | [0, 0, 0] | \n"
            "limit |  | a number above 0, or .inf or a list of 6 numbers | 10 | \n"
            "joints |  | a number of at least 0 or a list of numbers, one per joint | 0.1 | \n"
            "waypoints |  | a list of numbers |  | \n"
            "parts |  | a list |  | \n"
            "height |  | a number above 0 |  | \n"
            "margin |  | auto or a number above 0 | auto | \n"
            "target |  | ready or a list of numbers, one per joint | ready | \n"
            "none |  | none or a map | none | a part\n"
            "none.gain | 1/s | a number above 0 | 2 | how strongly\n"
            "omitted |  | none or a map | none | a part\n"
            "omitted.gain | 1/s | a number above 0 | 2 | how strongly\n"
            "kept |  | none or a map | none | a part\n"
            "kept.enabled |  | true or false | false | false keeps the other values and switches this off\n"
            "kept.gain | 1/s | a number above 0 | 2 | how strongly\n"
            "mode.on |  | true or false | true | \n"
            "mode.level |  | a whole number from 0 to 5 | 3 | \n"
            "nested.deep | m | a number | 4 | \n"
            "late |  | a whole number from -2147483648 to 2147483647 | 0 | \n"
            "later.part |  | none or a map | none | a part\n"
            "later.part.gain | 1/s | a number above 0 | 2 | how strongly\n"
            "apples |  | N apples | 1 apples | \n");
}

TEST(Describe, SameSeesEveryMember) {
  const Whole w = everything();
  EXPECT_TRUE(same(w, w));
  EXPECT_FALSE(same(w, Whole{}));
  const auto differs = [&](auto change) {
    Whole other = w;
    change(other);
    return !same(w, other) && !same(other, w);
  };
  EXPECT_TRUE(differs([](Whole& o) { o.apples.count = 1; }));
  EXPECT_TRUE(differs([](Whole& o) { o.kept.enabled = true; }));
  EXPECT_TRUE(differs([](Whole& o) { o.kept.gain = 1; }));
  EXPECT_TRUE(differs([](Whole& o) { o.margin.automatic = true; }));
  EXPECT_TRUE(differs([](Whole& o) { o.target.value[1] = 0; }));
  EXPECT_TRUE(differs([](Whole& o) { o.height.reset(); }));
  EXPECT_TRUE(differs([](Whole& o) { o.parts.pop_back(); }));
  EXPECT_TRUE(differs([](Whole& o) { o.deep = 0; }));
  EXPECT_TRUE(differs([](Whole& o) { o.common.width = 1; }));
  EXPECT_TRUE(differs([](Whole& o) { o.taste = Taste::kSweet; }));
  Whole nan = w;
  nan.speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(same(nan, Whole(nan)));
}

}  // namespace
}  // namespace moma::sample
