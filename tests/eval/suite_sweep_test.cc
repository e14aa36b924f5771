// Sweeps: which points come out, and how they are named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "controller/config/node.h"
#include "eval/suite/sweep.h"
#include "tests/eval/suite_fixture.h"

namespace moma::test {
namespace {

std::vector<Assignment> sweep(const std::string& text) { return read_sweep(config::parse_yaml(text, "test"), "sweep"); }

std::string sweep_refusal(const std::string& text) {
  try {
    sweep(text);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

std::string text_of(const std::vector<Assignment>& points) {
  std::string text;
  for (const Assignment& point : points) {
    for (const auto& [key, value] : point) text += key + "=" + value.scalar + " ";
    text += "| ";
  }
  return text;
}

TEST(Sweep, GridTakesEveryCombination) {
  EXPECT_EQ(text_of(sweep("{axes: {a: [1, 2], b.c: [x, y]}}")), "a=1 b.c=x | a=1 b.c=y | a=2 b.c=x | a=2 b.c=y | ");
  EXPECT_EQ(text_of(sweep("{design: grid, axes: {a: {linear: [0, 1], n: 5}}}")),
            "a=0 | a=0.25 | a=0.5 | a=0.75 | a=1 | ");
  EXPECT_EQ(text_of(sweep("{axes: {a: {log: [0.001, 0.1], n: 5}}}")),
            "a=0.001 | a=0.00316228 | a=0.01 | a=0.0316228 | a=0.1 | ");
}

TEST(Sweep, NoTwoValuesBecomeOne) {
  EXPECT_EQ(text_of(sweep("{axes: {a: {linear: [1000000, 1000004], n: 5}}}")),
            "a=1000000 | a=1000001 | a=1000002 | a=1000003 | a=1000004 | ");
  EXPECT_EQ(text_of(sweep("{axes: {a: {linear: [0.12345678, 1], n: 2}}}")), "a=0.12345678 | a=1 | ") << "as written";
  for (const char* text :
       {"{axes: {a: {log: [0.30000001, 0.30000004], n: 4}}}", "{axes: {a: {linear: [1, 1.0000000000000009], n: 5}}}",
        "{axes: {a: {linear: [-1.7e308, 1.7e308], n: 5}}}", "{axes: {a: {log: [5e-324, 1.7e308], n: 5}}}",
        "{design: latin_hypercube, n: 2000, axes: {a: {linear: [1000000, 1000004]}}}"}) {
    std::set<double> values;
    const auto points = sweep(text);
    for (const Assignment& point : points) {
      values.insert(std::strtod(point[0].second.scalar.c_str(), nullptr));
      EXPECT_TRUE(std::isfinite(*values.rbegin())) << text;
    }
    EXPECT_EQ(values.size(), points.size()) << text;
  }
  EXPECT_NE(sweep_refusal("{axes: {a: {linear: [1, 1.0000000000000002], n: 5}}}").find("no 5 different numbers"),
            std::string::npos);
  EXPECT_NE(
      sweep_refusal("{design: sobol, n: 100000, axes: {a: {linear: [0, 1]}, b: {linear: [0, 1]}, c: [1], d: [1], e: "
                    "[1], f: [1], g: [1], h: [1], i: [1], j: [1], k: [1], l: [1], m: [1], o: [1], p: [1], q: [1], r: "
                    "[1], s: [1], t: [1], u: [1], v: [1]}}")
          .find("more than 2000000 values"),
      std::string::npos);
}

TEST(Sweep, ListIsTakenAsItIs) { EXPECT_EQ(text_of(sweep("{points: [{a: 1, b: 2}, {a: 3}]}")), "a=1 b=2 | a=3 | "); }

TEST(Sweep, LatinHypercubeHasOnePointInEachStripe) {
  const auto points = latin_hypercube(7, 50, 4);
  for (std::size_t axis = 0; axis < 4; ++axis) {
    std::set<int> stripes;
    for (const auto& point : points) {
      ASSERT_GE(point[axis], 0.0);
      ASSERT_LT(point[axis], 1.0);
      stripes.insert(static_cast<int>(point[axis] * 50));
    }
    EXPECT_EQ(stripes.size(), 50u) << "axis " << axis;
  }
  EXPECT_EQ(points, latin_hypercube(7, 50, 4));
  EXPECT_NE(points, latin_hypercube(8, 50, 4));
  EXPECT_NE(points[0][0], points[0][1]) << "axes are drawn apart";
}

TEST(Sweep, SobolIsTheKnownSequence) {
  const auto points = sobol(7, 2);
  const std::vector<std::vector<double>> known = {{0.5, 0.5},     {0.75, 0.25},   {0.25, 0.75},  {0.375, 0.375},
                                                  {0.875, 0.875}, {0.625, 0.125}, {0.125, 0.625}};
  EXPECT_EQ(points, known);
}

TEST(Sweep, SampledAxes) {
  const auto points = sweep("{design: latin_hypercube, n: 10, seed: 3, axes: {a: {log: [0.01, 100]}, b: [p, q]}}");
  ASSERT_EQ(points.size(), 10u);
  int q = 0, above_one = 0;
  for (const Assignment& point : points) {
    const double a = std::stod(point[0].second.scalar);
    EXPECT_GE(a, 0.01);
    EXPECT_LE(a, 100.0);
    above_one += a > 1.0 ? 1 : 0;
    q += point[1].second.scalar == "q" ? 1 : 0;
  }
  EXPECT_EQ(q, 5) << "a list's values share the points";
  EXPECT_EQ(above_one, 5) << "half of a log range lies above its geometric middle";
}

TEST(Sweep, RefusesWhatItCannotDo) {
  EXPECT_NE(sweep_refusal("{axes: {}}").find("axes: missing"), std::string::npos);
  EXPECT_NE(sweep_refusal("{design: gird, axes: {a: [1]}}").find("did you mean grid?"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: []}}").find("axes.a: found an empty list"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: 3}}").find("axes.a: expected a list"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: {linear: [0, 1]}}}").find("axes.a.n: missing"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: {log: [0, 1], n: 3}}}").find("axes.a.log"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: {linear: [2, 1], n: 3}}}").find("expected low < high"), std::string::npos);
  EXPECT_NE(sweep_refusal("{axes: {a: {linear: [0, 1], log: [1, 2], n: 3}}}").find("expected one of the keys"),
            std::string::npos);
  EXPECT_NE(sweep_refusal("{design: sobol, axes: {a: {linear: [0, 1]}}}").find("n: missing"), std::string::npos);
  EXPECT_NE(sweep_refusal("{points: []}").find("expected a list of points"), std::string::npos);
  EXPECT_NE(sweep_refusal("{points: [3]}").find("points[0]: expected a map"), std::string::npos);
  EXPECT_NE(
      sweep_refusal("{axes: {a: {linear: [0, 1], n: 1000}, b: {linear: [0, 1], n: 1000}}}").find("more than 100000"),
      std::string::npos);
}

TEST(Sweep, PointsCarryTheirValuesAndNames) {
  SuiteFolder folder;
  const Suite suite =
      load_suite(folder.suite("sweep: {axes: {controller.lambda_q: [0.01, 0.1], simulation.time_limit: [5], "
                              "controllers.a.k_epsilon: [0.5, 1]}}\n",
                              "{a: controllers/plain.yaml, b: controllers/plain.yaml}"));
  ASSERT_EQ(suite.points.size(), 6u) << "b does not know a's axis";
  EXPECT_EQ(suite.points[0].controller, "a");
  EXPECT_EQ(suite.points[0].label, "lambda_q=0.01 simulation.time_limit=5 k_epsilon=0.5");
  EXPECT_EQ(suite.points[3].label, "lambda_q=0.1 simulation.time_limit=5 k_epsilon=1");
  EXPECT_EQ(suite.points[3].controller_params.k_epsilon, 1.0);
  EXPECT_EQ(suite.points[3].controller_params.lambda_q[0], 0.1);
  EXPECT_EQ(suite.points[3].params.dump(),
            R"({"controller.lambda_q":0.1,"simulation.time_limit":5,"controllers.a.k_epsilon":1})");
  EXPECT_EQ(suite.points[4].controller, "b");
  EXPECT_EQ(suite.points[4].label, "lambda_q=0.01 simulation.time_limit=5");
  EXPECT_EQ(suite.points[4].controller_params.k_epsilon, 0.5);
}

TEST(Sweep, MayGoOverRobotsAndFiles) {
  SuiteFolder folder;
  folder.write("controllers/other.yaml", "k_epsilon: 2\n");
  const Suite suite = load_suite(folder.suite(
      "sweep: {points: [{robot: robots/tiny.yaml, controllers.c: controllers/plain.yaml}, {robot.base.max_linear: 0.3, "
      "controllers.c: controllers/other.yaml}]}\n",
      "{c: {}}"));
  ASSERT_EQ(suite.points.size(), 2u);
  EXPECT_EQ(suite.points[0].label, "robot=tiny controllers.c=plain");
  EXPECT_EQ(suite.points[1].robot->model->base.max_linear, 0.3);
  EXPECT_EQ(suite.points[1].controller_params.k_epsilon, 2.0);
}

TEST(Sweep, RobotsThatStandInTheSuiteHaveShortNames) {
  SuiteFolder folder;
  const Suite suite =
      load_suite(folder.suite("sweep: {points: [{robot: {include: robots/tiny.yaml, name: wide}}, "
                              "{robot: {include: robots/tiny.yaml, name: wide, base: {max_linear: 0.3}}}]}\n",
                              "{c: {}}"));
  ASSERT_EQ(suite.points.size(), 2u);
  for (const SuitePoint& point : suite.points) {
    EXPECT_EQ(point.label.substr(0, 11), "robot=wide#") << point.label;
    EXPECT_EQ(point.label.size(), 17u) << point.label;
  }
  EXPECT_NE(suite.points[0].label, suite.points[1].label);
}

TEST(Sweep, WrongKeysAreRefusedByName) {
  SuiteFolder folder;
  const auto refused = [&](const std::string& key) {
    try {
      load_suite(folder.suite("sweep: {axes: {" + key + ": [1, 2]}}\n"));
    } catch (const config::ConfigError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  for (const std::string key : {"trials", "name", "samples", "metrics.peak", "notes", "tune"})
    EXPECT_NE(refused(key).find("'" + key + "' cannot be swept"), std::string::npos) << refused(key);
  EXPECT_NE(refused("simulaton.time_limit").find("did you mean simulation?"), std::string::npos)
      << refused("simulaton.time_limit");
  EXPECT_NE(refused("controller.lamda_q").find("suite.yaml:7:"), std::string::npos) << refused("controller.lamda_q");
}

}  // namespace
}  // namespace moma::test
