// Sixty control steps against numbers computed independently of moma (tests/data/qp_cases/README.md).
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/case/case_step.h"
#include "controller/case/solve.h"
#include "tests/support/kkt.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Asked for are 1e-10 for pose, J, nu and manipulability, 1e-8 relative for J_m, 1e-5 for distances, 1e-3 for x and
// 1e-6 for the cost. Every distance of these cases is exact here, so the last three are far tighter.
constexpr double kKinematics = 1e-10;
constexpr double kGradientRelative = 1e-8;
constexpr double kDistance = 1e-10;
constexpr double kDirection = 1e-9;  // normals and the rows made of them
constexpr double kSolution = 1e-9;
constexpr double kCost = 1e-9;

const fs::path& data_folder() {
  static const fs::path folder = fs::path(MOMA_SOURCE_DIR) / "tests" / "data" / "qp_cases";
  return folder;
}

const std::map<std::string, Json>& expectations() {
  static const std::map<std::string, Json> all = [] {
    std::map<std::string, Json> read;
    std::ifstream in(data_folder() / "expectations.jsonl");
    for (std::string line; std::getline(in, line);) {
      Json expected = Json::parse(line);
      const std::string name = expected["name"];
      read[name] = std::move(expected);
    }
    return read;
  }();
  return all;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& entry : expectations()) all.push_back(entry.first);
  return all;
}

double value(const Json& number) {
  if (number == "inf") return std::numeric_limits<double>::infinity();
  if (number == "-inf") return -std::numeric_limits<double>::infinity();
  return number.get<double>();
}

void expect_near(const Json& found, const Json& expected, double tolerance, const std::string& what) {
  if (expected.is_array()) {
    ASSERT_EQ(found.size(), expected.size()) << what;
    for (std::size_t i = 0; i < expected.size(); ++i)
      expect_near(found[i], expected[i], tolerance, what + "/" + std::to_string(i));
    return;
  }
  EXPECT_NEAR(value(found), value(expected), tolerance) << what;
}

class QpCase : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    given_ = read_case(data_folder() / "cases" / (GetParam() + ".json"));
    solved_ = solve(given_);
  }
  const Json& expected() const { return expectations().at(GetParam()); }

  ControlCase given_;
  Json solved_;
};

TEST_P(QpCase, Kinematics) {
  const Json& expected = this->expected();
  const Json& wxyz = solved_["pose"]["quaternion"];
  const Matrix3 R = Eigen::Quaterniond(wxyz[0].get<double>(), wxyz[1], wxyz[2], wxyz[3]).toRotationMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(solved_["pose"]["position"][i].get<double>(), expected["pose"][i][3].get<double>(), kKinematics);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(R(static_cast<int>(i), static_cast<int>(j)), expected["pose"][i][j].get<double>(), kKinematics);
  }
  expect_near(solved_["J"], expected["J"], kKinematics, "J");
  expect_near(solved_["error"], expected["error"], kKinematics, "error");
  expect_near(solved_["error_norm"], expected["error_norm"], kKinematics, "error_norm");
  expect_near(solved_["nu"], expected["nu"], kKinematics, "nu");
  expect_near(solved_["manipulability"], expected["manipulability"], kKinematics, "manipulability");
  expect_near(solved_["theta_eps"], expected["theta_eps"], kKinematics, "theta_eps");
  double largest = 0.0;
  for (const Json& g : expected["J_m"]) largest = std::max(largest, std::abs(g.get<double>()));
  expect_near(solved_["J_m"], expected["J_m"], kGradientRelative * largest, "J_m");
}

TEST_P(QpCase, ObjectiveAndBounds) {
  const Json& expected = this->expected();
  const std::size_t n = expected["Q_diagonal"].size();
  ASSERT_EQ(solved_["Q"].size(), n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      EXPECT_NEAR(solved_["Q"][i][j].get<double>(), i == j ? expected["Q_diagonal"][i].get<double>() : 0.0, 1e-8);
  expect_near(solved_["c"], expected["c"], 1e-9, "c");
  expect_near(solved_["lb"], expected["lb"], kKinematics, "lb");
  expect_near(solved_["ub"], expected["ub"], kKinematics, "ub");
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(solved_["rows"][i], "tracking/" + std::to_string(i));
    expect_near(solved_["lbA"][i], expected["lbA"][i], kKinematics, "lbA");
    expect_near(solved_["ubA"][i], expected["ubA"][i], kKinematics, "ubA");
  }
}

TEST_P(QpCase, DistancesAndRows) {
  const Json& expected = this->expected();
  std::map<std::string, std::size_t> rows;
  for (std::size_t i = 0; i < solved_["rows"].size(); ++i) rows[solved_["rows"][i]] = i;
  EXPECT_EQ(rows.size(), 6 + expected["pairs"].size()) << "names repeated, or rows too many or too few";
  EXPECT_EQ(solved_["distances"].size(), expected["pairs"].size() + expected["left_out"].size());
  for (const Json& pair : expected["pairs"]) {
    const std::string name = pair["row"];
    ASSERT_TRUE(rows.contains(name)) << name;
    bool seen = false;
    for (const Json& found : solved_["distances"]) {
      const std::string kind = found["kind"], shape = found["shape"], other = found["object"];
      if ((kind == "self" ? "self/" + shape + "/" + other : "object/" + other + "/" + shape) != name) continue;
      seen = true;
      EXPECT_NEAR(found["d"].get<double>(), pair["d"].get<double>(), kDistance) << name;
      expect_near(found["normal"], pair["normal"], kDirection, name + " normal");
    }
    EXPECT_TRUE(seen) << name << " is not among the distances";
    const std::size_t row = rows[name];
    EXPECT_EQ(solved_["lbA"][row], "-inf") << name;
    EXPECT_NEAR(value(solved_["ubA"][row]), pair["ubA"].get<double>(), kDirection) << name;
    expect_near(solved_["A"][row], pair["A"], kDirection, name + " row");
  }
  for (const Json& pair : expected["left_out"]) {
    bool seen = false;
    for (const Json& found : solved_["distances"]) {
      seen = seen || (found["link"] == pair["link"] && found["object"] == pair["object"] &&
                      std::abs(found["d"].get<double>() - pair["d"].get<double>()) < kDistance);
    }
    EXPECT_TRUE(seen) << pair;
  }
}

TEST_P(QpCase, Solution) {
  const Json& expected = this->expected();
  EXPECT_EQ(solved_["status"], expected["status"]);
  EXPECT_EQ(solved_["fallback"], expected["fallback"]);
  Json x = solved_["qdot"];
  for (const Json& d : solved_["delta"]) x.push_back(d);
  expect_near(x, expected["x"], kSolution, "x");
  if (expected.contains("cost")) {
    const double cost = expected["cost"];
    EXPECT_NEAR(solved_["cost"].get<double>(), cost, kCost * std::max(1.0, std::abs(cost)));
  }
  EXPECT_LT(solved_["kkt_residual"].get<double>(), 1e-7);
  // And by multipliers that no solver found.
  const CaseStep step(given_);
  const QpProblem p = step.controller.final_problem();
  const MatrixX Q = p.H.asDiagonal(), A = p.A.topRows(p.rows);
  const VectorX lbA = p.lbA.head(p.rows), ubA = p.ubA.head(p.rows);
  EXPECT_LT(check_kkt({Q, p.g, A, lbA, ubA, p.lb, p.ub}, step.controller.solution().x.head(p.n())).residual(), 1e-7);
}

TEST_P(QpCase, EverySolverAgrees) {
  const CaseStep daqp(given_);
  for (const test::NamedSolver& solver : test::solvers()) {
    const CaseStep other(given_, solver.make);
    EXPECT_EQ(other.result.status, daqp.result.status) << solver.name;
    EXPECT_EQ(other.result.fallback, daqp.result.fallback) << solver.name;
    EXPECT_NEAR(other.controller.cost(), daqp.controller.cost(), 1e-6) << solver.name;
    EXPECT_LT(other.controller.kkt_residual(), 1e-6) << solver.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, QpCase, testing::ValuesIn(names()), [](const auto& test) { return test.param; });

TEST(QpCases, AllSixtyAreThere) {
  int solved = 0, infeasible = 0;
  for (const auto& [name, e] : expectations()) (e["status"] == "solved" ? solved : infeasible) += 1;
  EXPECT_EQ(solved, 58);
  EXPECT_EQ(infeasible, 2);
}

}  // namespace
}  // namespace moma
