// The trace file: complete, in the documented form, and true to the kinematics it claims. The boxes of a map, against
// its cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "controller/case/case_step.h"
#include "controller/case/solve.h"
#include "controller/controller_core.h"
#include "eval/trial/trial.h"
#include "eval/trial/trial_detail.h"
#include "tests/eval/suite_fixture.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

using nlohmann::ordered_json;

class TrialTrace : public ::testing::Test {
 protected:
  void SetUp() override {
    const Suite suite = load_suite(folder_.suite("", "{plain: {servo: {max_linear: 1}, limits: {acceleration: 5}}}"));
    const SuitePoint& point = suite.points[0];
    const World world = point.worlds.make(point.robot->model, 1);
    const TrialOutput output = run_trial(point, world);
    steps_ = output.row.steps;
    trace_ = ordered_json::parse(trace_json(point, world, output, "0123456789abcdef").dump());
    // Once more from what the trace holds.
    again_ = run_trial(point, world_from_json(trace_["world"], "trace")).row;
    row_ = output.row;
  }

  SuiteFolder folder_;
  ordered_json trace_;
  TrialRow row_, again_;
  int steps_ = 0;
};

TEST_F(TrialTrace, HoldsEverythingThatWasSimulated) {
  for (const char* key :
       {"trial", "outcome", "robot", "success", "stuck", "infeasible", "controller", "world", "simulation", "samples"})
    EXPECT_TRUE(trace_.contains(key)) << key;
  EXPECT_EQ(trace_["trial"], "0123456789abcdef");
  EXPECT_NE(trace_["robot"]["urdf_text"].get<std::string>().find("<robot"), std::string::npos);
  EXPECT_EQ(trace_["simulation"]["mode"], "kinematic");
  ASSERT_GT(steps_, 10);
  ASSERT_EQ(trace_["samples"].size(), static_cast<std::size_t>(steps_));
  const ordered_json& sample = trace_["samples"][3];
  for (const char* key : {"t", "base", "q", "qdot", "command", "error", "slack", "manipulability", "least_distance",
                          "status", "fallback"})
    EXPECT_TRUE(sample.contains(key)) << key;
  EXPECT_EQ(sample["base"].size(), 3u);
  EXPECT_EQ(sample["q"].size(), 3u);
  EXPECT_EQ(sample["command"].size(), 5u);
  EXPECT_EQ(sample["error"].size(), 6u);
  EXPECT_EQ(sample["status"], "solved");
  EXPECT_EQ(sample["least_distance"], "inf") << "an open world has no objects";
}

TEST_F(TrialTrace, EachStateFollowsFromTheOneBeforeAndItsCommand) {
  const double dt = 0.02;
  for (std::size_t k = 0; k + 1 < trace_["samples"].size(); ++k) {
    const ordered_json& now = trace_["samples"][k];
    const ordered_json& next = trace_["samples"][k + 1];
    EXPECT_NEAR(now["t"].get<double>(), dt * static_cast<double>(k), 1e-12);
    const double v = now["command"][0], w = now["command"][1], phi = now["base"][2];
    // The exact arc of constant speeds, written out: chord along the mean heading.
    const double half = 0.5 * w * dt;
    const double chord = v * dt * (std::abs(half) < 1e-12 ? 1.0 : std::sin(half) / half);
    EXPECT_NEAR(next["base"][0].get<double>(), now["base"][0].get<double>() + chord * std::cos(phi + half), 1e-12);
    EXPECT_NEAR(next["base"][1].get<double>(), now["base"][1].get<double>() + chord * std::sin(phi + half), 1e-12);
    EXPECT_NEAR(next["base"][2].get<double>(), phi + w * dt, 1e-12);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(next["q"][i].get<double>(), now["q"][i].get<double>() + dt * now["command"][2 + i].get<double>(),
                  1e-12);
    }
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(next["qdot"][i], now["command"][i]) << "the previous command";
  }
}

TEST_F(TrialTrace, TheWorldInItGivesTheSameTrial) {
  EXPECT_EQ(again_.outcome, row_.outcome);
  EXPECT_EQ(again_.steps, row_.steps);
  EXPECT_EQ(again_.path_ee_m, row_.path_ee_m);
  EXPECT_EQ(again_.jerk_joint_rms, row_.jerk_joint_rms);
}

/// moma's controller; its map and where its base is in the steps that are kept, and where its head looks.
struct MapWitness final : StepController {
  struct Picture {
    OccupancyMap map;
    Vector3 base;
    int left_out;
  };
  MapWitness(const TrialSpec& spec, std::map<int, Picture>& pictures_out, std::map<double, Gaze>& gazes_out)
      : controller(spec.robot->model, told_params(spec), spec.simulation.control_period),
        pictures(pictures_out),
        gazes(gazes_out) {}
  void reset(std::span<const ObjectShape> objects) override { controller.reset(objects); }
  void see(const DepthFrame& frame) noexcept override {
    if (frame.sensor == 0) gazes[frame.time] = frame.gaze;
    controller.see(frame);
  }
  Gaze gaze(int sensor) const noexcept override { return controller.gaze(sensor); }
  void step(const Observation& o, StepResult& result) noexcept override {
    controller.step(o, result);
    const SeenMap& map = controller.map();
    pictures.try_emplace(static_cast<int>(o.time * TrialDetail::kMapRate + 1e-6), map.map(), o.base, map.left_out());
  }
  void prepare(StepResult& result) const override { controller.prepare(result); }

  ControllerCore controller;
  std::map<int, Picture>& pictures;
  std::map<double, Gaze>& gazes;  // of the first sensor
};

// A case has the boxes of the map as the step got them, so that its command is the trial's, and says in words where
// unseen space holds it.
TEST(CaseOfStep, HasTheMapOfAStepThatIsToldByDepth) {
  const Suite suite =
      load_suite(MOMA_SOURCE_DIR "/configs/suites/depth.yaml", {{"simulation.time_limit", "1"},
                                                                {"worlds.seed", "717171"},
                                                                {"worlds.start_room", "0.4"},
                                                                {"controllers.moma.map.unseen.start", "0.4"}});
  const SuitePoint& point = suite.points[0];
  const World world = point.worlds.make(point.robot->model, 1);
  const std::vector<Sample> trace = run_trial(point, world).trace;
  int held = 0, told = 0, other = 0;
  for (long k = 9; k < static_cast<long>(trace.size()); k += 5) {
    const ControlCase stored = case_of_step(point, world, k);
    ControlCase read = read_case(config::parse_yaml(case_to_json(stored).dump(), "case.json"));
    const CaseStep step(read);
    EXPECT_EQ(step.result.command, trace[static_cast<std::size_t>(k)].command) << "step " << k;
    bool waits = false;
    const QpProblem problem = step.controller.final_problem();
    for (int i = 0; i < problem.rows; ++i) {
      const RowId& id = problem.ids[static_cast<std::size_t>(i)];
      if (id.kind != RowKind::kObject || step.controller.map().states()[static_cast<std::size_t>(id.second)].seen)
        continue;
      waits |= problem.ubA[i] - problem.A.row(i).dot(step.controller.solution().x.head(problem.n())) < 1e-7;
    }
    const bool says = explain(read).find("Unseen space holds the motion with") != std::string::npos;
    EXPECT_EQ(says, waits) << "step " << k;
    held += waits ? 1 : 0;
    read.memory.map.clear();
    other += CaseStep(read).result.command == trace[static_cast<std::size_t>(k)].command ? 0 : 1;
    ++told;
  }
  EXPECT_GT(told, 6);
  EXPECT_GT(held, 0);
  EXPECT_GT(other, 0) << "the map has nothing to do with the commands";
  EXPECT_THROW(case_of_step(point, world, 0), std::invalid_argument) << "no frame has come";
  const Json good = case_to_json(case_of_step(point, world, 9));
  const auto error_of = [](const Json& json) -> std::string {
    try {
      read_case(config::parse_yaml(json.dump(), "case.json"));
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "";
  };
  Json bad = good;
  bad["state"]["map"][0]["object"] = 416;
  EXPECT_NE(error_of(bad).find("state.map[0].object: found 416, but the controller's map has 416 objects"),
            std::string::npos)
      << error_of(bad);
  bad = good;
  bad["controller"]["map"]["enabled"] = false;
  EXPECT_NE(error_of(bad).find("state.map: the controller has no map"), std::string::npos) << error_of(bad);
}

// Where boxes are made with each frame they are the cells, to the last one. The front camera is on a head.
TEST(TrialDetail, HasTheBoxesOfTheMapsCellsAndWhereTheHeadLooks) {
  const Suite suite =
      load_suite(MOMA_SOURCE_DIR "/configs/suites/depth.yaml",
                 {{"simulation", "{mode: kinematic, time_limit: 0.8}"},
                  {"robot", "{include: " MOMA_SOURCE_DIR "/configs/robots/frankie_cameras.yaml, sensors: ["
                            "{name: front, position: [-0.23, 0, 1.5], rpy: [0, 0.7, 0], field_of_view: [1.571, "
                            "1.571], head: {axes: [-0.28, 0, 1.5], pan: [-2, 2], tilt: [-0.5, 0.5]}}, "
                            "{name: scanner, position: [0.3, 0.2, 0.2], field_of_view: [4.712, 0], columns: "
                            "540, rows: 1, range: 8, rate: 15}]}"},
                  {"controllers.moma.plan", "none"},
                  {"controllers.moma.map.often", "0"},
                  {"controllers.moma.map.boxes", "2000"},
                  {"controllers.moma.map.unseen.least", "0"}});
  const SuitePoint& point = suite.points[0];
  const World world = point.worlds.make(point.robot->model, 0);
  TrialDetail detail;
  run_trial(point, world, detail);
  std::map<int, MapWitness::Picture> pictures;
  std::map<double, Gaze> gazes;
  TrialParts parts;
  parts.controller = [&](const TrialSpec& spec) { return std::make_unique<MapWitness>(spec, pictures, gazes); };
  run_trial(point, world, parts);
  ASSERT_EQ(pictures.size(), 4u);
  EXPECT_EQ(detail.cell, 0.05);
  int changed = 0;
  for (const auto& [picture, at] : pictures) {
    std::map<int, int> covered;  // of the window's cells, how often
    Eigen::Vector3i c;
    const Eigen::Vector3i cells = at.map.cells();
    const auto number = [&] { return (c.x() * cells.y() + c.y()) * cells.z() + c.z(); };
    int unseen = 0;
    for (const TrialDetail::Box& box : detail.boxes) {
      changed += box.from == picture || box.to == picture ? 1 : 0;
      if (picture < box.from || box.to <= picture) continue;
      const Eigen::Vector3i low = box.cells.low - at.map.origin(), high = box.cells.high - at.map.origin();
      for (c.x() = low.x(); c.x() < high.x(); ++c.x())
        for (c.y() = low.y(); c.y() < high.y(); ++c.y())
          for (c.z() = low.z(); c.z() < high.z(); ++c.z()) {
            EXPECT_EQ(at.map.occupied(c), box.seen) << picture << ": " << c.transpose();
            EXPECT_EQ(at.map.unseen(c), !box.seen) << picture << ": " << c.transpose();
            if (box.seen) ++covered[number()];
            unseen += box.seen ? 0 : 1;
          }
    }
    EXPECT_GT(unseen, 100);
    ASSERT_EQ(at.left_out, 0);
    int occupied = 0;
    const Eigen::Vector3i middle = at.map.cell_of(at.base);
    for (c.x() = middle.x() - 49; c.x() <= middle.x() + 49; ++c.x())
      for (c.y() = middle.y() - 49; c.y() <= middle.y() + 49; ++c.y())
        for (c.z() = 0; c.z() < cells.z(); ++c.z()) {
          if (!at.map.occupied(c)) continue;
          ++occupied;
          const auto found = covered.find(number());
          EXPECT_EQ(found == covered.end() ? 0 : found->second, 1) << picture << ": " << c.transpose();
        }
    EXPECT_GT(occupied, 50);
  }
  EXPECT_GT(changed, 20);
  ASSERT_EQ(detail.looks.size(), gazes.size());
  double turned = 0.0;
  for (const TrialDetail::Look& look : detail.looks) {
    EXPECT_EQ(look.sensor, 0);
    EXPECT_EQ(look.gaze, gazes.at(look.t));
    turned = std::max(turned, std::abs(look.gaze.pan));
  }
  EXPECT_GT(turned, 0.1);
}

}  // namespace
}  // namespace moma::test
