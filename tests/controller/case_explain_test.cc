// `moma solve --explain`: the cost's terms, the sets of constraints that exclude each other, and the words.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/case/case_step.h"
#include "controller/case/infeasible_set.h"
#include "controller/case/solve.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

namespace fs = std::filesystem;

const fs::path kStoredCases = fs::path(MOMA_SOURCE_DIR) / "tests" / "data" / "qp_cases" / "cases";

std::vector<fs::path> all_cases() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kStoredCases)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The problem with only these constraints.
QpProblem restricted(const QpProblem& p, const std::vector<ConstraintId>& kept) {
  QpProblem out;
  out.allocate(p.n(), std::max(p.rows, 1));
  out.H.setOnes();
  out.lb.setConstant(-kInfinity);
  out.ub.setConstant(kInfinity);
  for (const ConstraintId& id : kept) {
    if (id.kind == ConstraintId::Kind::kRow)
      out.A.row(out.append({}, p.lbA[id.index], p.ubA[id.index])) = p.A.row(id.index);
    if (id.kind == ConstraintId::Kind::kLowerBound) out.lb[id.index] = p.lb[id.index];
    if (id.kind == ConstraintId::Kind::kUpperBound) out.ub[id.index] = p.ub[id.index];
  }
  return out;
}

// Another solver than the one the search uses, where there is one.
StepStatus feasibility(const QpProblem& p) {
  const auto solver = test::solvers().back().make();
  QpSolution solution;
  solution.allocate(p.n(), p.capacity());
  solver->allocate(p.n(), p.capacity());
  return solver->solve(p, solution);
}

bool mentions(const std::string& text, const std::string& word) { return text.find(word) != std::string::npos; }

TEST(CaseExplain, TermsAddUpToTheCost) {
  for (const fs::path& file : all_cases()) {
    const ControlCase given = read_case(file);
    const CaseStep step(given);
    double sum = 0.0;
    for (const TermCost& term : step.controller.term_costs()) sum += term.value;
    EXPECT_NEAR(sum, step.controller.cost(), 1e-12 * std::max(1.0, std::abs(sum))) << file;
  }
}

TEST(CaseExplain, InfeasibleSetsAreInfeasibleAndMinimal) {
  for (const char* name : {"panda_015.json", "ur5_235.json"}) {
    const ControlCase given = read_case(kStoredCases / name);
    const CaseStep step(given);
    const QpProblem& problem = step.controller.problem();
    const auto set = minimal_infeasible_set(problem, step.controller.model().num_velocities());
    ASSERT_FALSE(set.empty()) << name;
    EXPECT_EQ(feasibility(restricted(problem, set)), StepStatus::kInfeasible) << name;
    for (std::size_t drop = 0; drop < set.size(); ++drop) {
      auto rest = set;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(drop));
      EXPECT_EQ(feasibility(restricted(problem, rest)), StepStatus::kSolved) << name << " without " << drop;
    }
  }
}

TEST(CaseExplain, FeasibleProblemsHaveNoInfeasibleSet) {
  const ControlCase given = read_case(kStoredCases / "frankie_119.json");
  const CaseStep step(given);
  EXPECT_TRUE(minimal_infeasible_set(step.controller.problem(), 9).empty());
}

TEST(CaseExplain, SaysWhatHoldsTheCommand) {
  const std::string text = explain(read_case(kStoredCases / "frankie_119.json"));
  EXPECT_TRUE(mentions(text, "Status: solved")) << text;
  EXPECT_TRUE(mentions(text, "object/o1/panda_link5/2: distance 0.07008 m, may approach")) << text;
  EXPECT_TRUE(mentions(text, "panda_joint3 at 0.03343 rad/s: the upper joint limit, 0.006566 away")) << text;
  EXPECT_TRUE(mentions(text, "slack (not following the goal) dominates")) << text;
}

TEST(CaseExplain, NamesWhatExcludesWhat) {
  // The ball comes faster than the first joint can turn away: both are named, nothing else is needed.
  const std::string text = explain(read_case(kStoredCases / "panda_015.json"));
  EXPECT_TRUE(mentions(text, "Status: infeasible, fallback: relaxed")) << text;
  EXPECT_TRUE(mentions(text, "cannot be met together")) << text;
  EXPECT_TRUE(mentions(text, "object/o1/panda_link2: distance 0.08783 m, must retreat at no less than 0.1674 m/s"))
      << text;
  EXPECT_TRUE(mentions(text, "panda_joint1 >= -2.175 rad/s: the speed limit")) << text;
}

TEST(CaseExplain, AccelerationAndClosedForms) {
  ControlCase given = read_case(kStoredCases / "panda_001.json");
  given.controller.acceleration_limit = VectorX::Constant(7, 0.5);
  EXPECT_TRUE(mentions(explain(given), "the acceleration limit")) << explain(given);
  given.controller.method = Method::kRrmc;
  EXPECT_TRUE(mentions(explain(given), "solves no QP")) << explain(given);
  const auto json = solve(given);
  EXPECT_TRUE(json["Q"].empty());
  EXPECT_TRUE(json["kkt_residual"].is_null());
  EXPECT_EQ(json["qdot"].size(), 7u);
}

TEST(CaseExplain, TellsABaseHeldByItsDrivesFromOneAtItsSpeedLimit) {
  ControlCase given = read_case(kStoredCases / "frankie_119.json");
  given.objects.clear();
  given.observation.objects.clear();
  given.observation.qdot.setZero();
  given.controller.base_weight = {false, 1e-6};
  given.observation.goal.X_WG.translation() += Vector3(30.0, 30.0, 0.0);
  EXPECT_TRUE(mentions(explain(given), "m/s: the speed limit")) << explain(given);
  given.controller.base_share = 0.5;
  EXPECT_TRUE(mentions(explain(given), "m/s: the acceleration limit")) << explain(given);
  given.controller.base_share = 0.0;
  given.controller.base_first.enabled = true;
  given.controller.base_first.reach =
      (given.observation.goal.X_WG.translation() - Vector3(given.observation.base.x(), given.observation.base.y(), 0.0))
          .head<2>()
          .norm();
  given.controller.base_first.bearing = 4.0;
  EXPECT_TRUE(mentions(explain(given), "the base stands while the arm moves")) << explain(given);
}

TEST(CaseExplain, EveryCaseIsExplained) {
  for (const fs::path& file : all_cases()) {
    const std::string text = explain(read_case(file));
    EXPECT_FALSE(mentions(text, "nan")) << file << text;
    EXPECT_TRUE(mentions(text, "dominates")) << file << text;
  }
}

TEST(CaseExplain, LayoutIsTheSameJson) {
  const auto json = solve(read_case(kStoredCases / "frankie_119.json"));
  const std::string text = layout(json);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), json);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 150);
}

}  // namespace
}  // namespace moma
