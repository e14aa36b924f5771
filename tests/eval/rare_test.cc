// Rare events of real trials: moved worlds, their probability by splitting and by crude trials, with a store and
// without.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/model/kinematics.h"
#include "eval/run/break.h"
#include "eval/run/evaluate.h"
#include "eval/run/moved_trials.h"
#include "eval/run/risk.h"
#include "eval/run/shrink.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/writer.h"
#include "eval/trial/trial.h"
#include "suite_fixture.h"
#include "world/draws.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

constexpr std::uint32_t mask(Stream stream) { return 1U << static_cast<unsigned>(stream); }
constexpr std::uint32_t kAll = 127;

/// A suite of cluttered and open worlds with a robot that sees badly.
class Rare : public ::testing::Test {
 protected:
  Suite suite(const std::string& families = "{clutter: {objects: 4}}") const {
    return load_suite(
        folder_.write("rare.yaml",
                      "name: rare\nrobot: robots/tiny.yaml\n"
                      "controllers: {plain: controllers/plain.yaml}\n"
                      "worlds: {seed: 3, families: " +
                          families +
                          "}\n"
                          "simulation: {mode: kinematic, time_limit: 3, control_period: 0.04}\n"
                          "disturbances: {objects: {noise: {position: 0.03}}, joints: {noise: 0.002}}\ntrials: 5\n"));
  }
  static RiskRequest request(std::size_t particles, std::size_t replicates) {
    RiskRequest request;
    request.threads = 2;
    request.splitting.particles = particles;
    request.splitting.replicates = replicates;
    return request;
  }
  std::filesystem::path path(const char* name) const { return folder_.root() / name; }

  test::SuiteFolder folder_;
};

void expect_same(const Risk& a, const Risk& b) {
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    EXPECT_EQ(a.rows[i].estimate.p, b.rows[i].estimate.p);
    EXPECT_EQ(a.rows[i].estimate.interval.high, b.rows[i].estimate.interval.high);
    EXPECT_EQ(a.rows[i].trials, b.rows[i].trials);
    EXPECT_EQ(a.rows[i].crude, b.rows[i].crude);
  }
}

TEST(RareEvents, AreOutcomesAndMetricsBeyondAValue) {
  TrialRow row;
  row.outcome = Outcome::kSuccess;
  row.clearance_min_m = 0.03;
  const RareEvent collision = RareEvent::read("collision"), near = RareEvent::read("clearance_min_m<0.04"),
                  far = RareEvent::read("clearance_min_m>0.04");
  EXPECT_EQ(collision.score(row), -0.03);
  EXPECT_EQ(collision.value_of(-0.03), 0.03);
  EXPECT_EQ(near.score(row), risk::kEvent);
  EXPECT_EQ(far.score(row), 0.03);
  row.outcome = Outcome::kCollision;
  EXPECT_EQ(collision.score(row), risk::kEvent);
  row.clearance_min_m = kAbsent;
  EXPECT_FALSE(near.happened(row));
  EXPECT_EQ(near.score(row), -risk::kEvent);
  row.clearance_min_m = 0.0;
  row.outcome = Outcome::kError;
  EXPECT_FALSE(near.happened(row));
  EXPECT_EQ(near.score(row), -risk::kEvent);
  for (const char* bad : {"", "colision", "clearance_min_m<", "clearance_min_m<1x", "clearance<1", "reason<1", "tipped",
                          "t_step_max_us>100", "time_end_s>inf"})
    EXPECT_THROW(RareEvent::read(bad), std::invalid_argument) << bad;
}

TEST_F(Rare, MovedWorldsKeepTheirLawAndFrozenTheyAreTheSame) {
  const Suite suite = this->suite();
  const SuitePoint& point = suite.points.front();
  const int n = 400;
  std::vector<double> plain, moved;
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    const Moves moves = {{3 * index, 0.5, 0.5, kAll}, {3 * index + 1, 1.0, 0.3, kAll}, {3 * index + 2, 0.2, 1.0, kAll}};
    const World world = point.worlds.make(point.robot->model, index, nullptr, std::make_shared<Moves>(moves));
    plain.push_back(point.worlds.make(point.robot->model, index + n).difficulty.goal_distance_m);
    moved.push_back(world.difficulty.goal_distance_m);
    if (i % 100 != 0) continue;
    const TrialRow row = run_trial(point, world).row;
    const World again = world_from_json(to_json(world), "again");
    EXPECT_EQ(run_trial(point, again).row.path_ee_m, row.path_ee_m);
    World without = again;
    without.moves = nullptr;
    EXPECT_NE(run_trial(point, without).row.path_ee_m, row.path_ee_m);  // the noise is another
  }
  std::sort(plain.begin(), plain.end());
  std::sort(moved.begin(), moved.end());
  double apart = 0.0;  // Kolmogorov and Smirnov's distance of two samples
  for (std::size_t i = 0, k = 0; i < plain.size(); ++i) {
    while (k < moved.size() && moved[k] <= plain[i]) ++k;
    apart = std::max(apart, std::abs(static_cast<double>(k) - static_cast<double>(i + 1)) / n);
  }
  EXPECT_LT(apart * std::sqrt(n / 2.0), 1.95);
}

TEST_F(Rare, RiskAgreesWithCrudeTrials) {
  RiskRequest request = this->request(40, 8);
  request.splitting.draws = 2;
  request.crude = 1000;
  const Risk risk = estimate_risk(request, suite(), RareEvent::read("clearance_min_m<0.025"));
  ASSERT_EQ(risk.rows.size(), 1u);
  const RiskRow& row = risk.rows.front();
  EXPECT_GT(row.crude, 0.003);
  EXPECT_LT(row.crude, 0.15);
  EXPECT_GT(row.trials, 1000u);
  EXPECT_FALSE(row.refused());
  EXPECT_LT(row.estimate.interval.low, row.crude_interval.high);
  EXPECT_GT(row.estimate.interval.high, row.crude_interval.low);
  EXPECT_EQ(row.crude_trials, 1000u);
  ASSERT_EQ(row.moves.size(), 4u);
  for (const auto& [name, moves] : row.moves) {
    EXPECT_GT(moves.accepted, 0u) << name;
    EXPECT_LT(moves.accepted, moves.proposed) << name;
  }
}

TEST_F(Rare, RiskIsTheSameForAnyThreadsAndStops) {
  const Suite suite = this->suite("{clutter: {objects: 4, weight: 3}, open: {weight: 1}}");
  const RareEvent event = RareEvent::read("clearance_min_m<0.025");
  RiskRequest request = this->request(10, 3);
  request.crude = 40;
  const Risk whole = estimate_risk(request, suite, event);
  ASSERT_EQ(whole.rows.size(), 3u);
  EXPECT_EQ(whole.rows[2].family, "all");
  EXPECT_NEAR(whole.rows[2].estimate.p, 0.75 * whole.rows[0].estimate.p + 0.25 * whole.rows[1].estimate.p, 1e-12);
  EXPECT_NEAR(whole.rows[2].crude, 0.75 * whole.rows[0].crude + 0.25 * whole.rows[1].crude, 1e-12);

  request.threads = 1;
  request.file = path("risk.db");
  request.arguments = {"moma", "risk", "rare.yaml"};
  std::atomic<bool> stop = false;
  request.stop = &stop;
  Listener listener;
  int levels = 0;
  listener.note = [&](const std::string& text) {
    stop = text.find("in progress") != std::string::npos && ++levels == 2;
  };
  const Risk stopped = estimate_risk(request, suite, event, listener);
  EXPECT_EQ(stopped.end, End::kStopped);
  EXPECT_NE(stopped.stopped.find("moma risk rare.yaml"), std::string::npos) << stopped.stopped;

  stop = false;
  std::string last;
  listener.note = [&](const std::string& text) { last = text; };
  const Risk resumed = estimate_risk(request, suite, event, listener);
  expect_same(whole, resumed);
  EXPECT_EQ(last.find(", 0 taken"), std::string::npos) << last;
  const Risk again = estimate_risk(request, suite, event, listener);
  expect_same(whole, again);
  EXPECT_EQ(last.find("0 trials computed"), 0u) << last;
  EXPECT_TRUE(store::Reader(request.file).integrity_problems().empty());

  // Kept with the invocation, for the page; that of the stopped one has none.
  const store::QueryResult kept = store::query(request.file, "SELECT risk FROM invocation ORDER BY id");
  ASSERT_EQ(kept.rows.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(kept.rows[0][0]));
  EXPECT_EQ(kept.rows[1][0], kept.rows[2][0]);
  const auto rows = nlohmann::json::parse(std::get<std::string>(kept.rows[2][0]));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["p"], whole.rows[0].estimate.p);
  EXPECT_EQ(rows[2]["family"], "all");
  EXPECT_EQ(rows[0]["at"], 0.025);
  const auto& way = rows[0]["way"];
  ASSERT_GE(way.size(), 2u);
  EXPECT_GT(way.front()[0], way.back()[0]);  // nearer and nearer
  EXPECT_GE(way.front()[1], way.back()[1]);
  EXPECT_GE(way.back()[1], rows[0]["p"]);
}

TEST_F(Rare, UntilAddsReplicates) {
  const Suite suite = this->suite();
  const RareEvent event = RareEvent::read("clearance_min_m<0.025");
  RiskRequest request = this->request(10, 6);
  request.crude = 0;
  const Risk six = estimate_risk(request, suite, event);
  request.splitting.replicates = 2;
  request.until = 1.01;
  request.most = 7;
  const Risk never = estimate_risk(request, suite, event);
  ASSERT_EQ(never.rows.size(), 1u);
  EXPECT_EQ(never.rows[0].replicates, 6u);
  expect_same(six, never);
  ASSERT_FALSE(never.warnings.empty());
  EXPECT_NE(never.warnings[0].find("NOT within a factor of 1.01"), std::string::npos) << never.warnings[0];

  request.until = 0.999 * never.rows[0].estimate.factor() + 0.01;
  request.most = 100;
  const Risk enough = estimate_risk(request, suite, event);
  EXPECT_LE(enough.rows[0].estimate.factor(), *request.until);
  EXPECT_EQ(enough.rows[0].replicates % 2, 0u);
  EXPECT_TRUE(enough.warnings.empty()) << enough.warnings.front();
  EXPECT_NE(price_of_risk(request, suite).find("at most 50 times that"), std::string::npos);
}

TEST_F(Rare, RiskNeedsWorldsThatAreDrawn) {
  const Suite drawn = suite();
  const SuitePoint& point = drawn.points.front();
  folder_.write("one.jsonl", to_json(point.worlds.make(point.robot->model, 0)).dump() + "\n");
  const Suite frozen = load_suite(
      folder_.write("frozen.yaml",
                    "name: frozen\nrobot: robots/tiny.yaml\ncontrollers: {plain: controllers/plain.yaml}\n"
                    "worlds: {frozen: one.jsonl}\nsimulation: {mode: kinematic, time_limit: 3}\ntrials: 1\n"));
  EXPECT_THROW(estimate_risk(request(10, 2), frozen, RareEvent::read("collision")), RunError);
}

TEST_F(Rare, BreakFindsWorldsThatFailAgain) {
  const Suite suite = this->suite();
  const RareEvent event = RareEvent::read("clearance_min_m<0.02");  // about 3 of 1,000
  BreakRequest request;
  request.threads = 2;
  request.crude = 200;
  request.nearest = 0.02;
  request.noises = 10;
  request.splitting.particles = 20;
  request.splitting.replicates = 2;
  const Broken broken = break_suite(request, suite, event);
  EXPECT_EQ(broken.end, End::kFinished);
  ASSERT_GE(broken.failures.size(), 1u);
  EXPECT_GE(broken.trials, 200u + 4 * 10);
  std::string worlds;
  std::set<std::string> distinct, by;
  for (const Failure& failure : broken.failures) {
    worlds += to_json(failure.world).dump() + "\n";
    by.insert(failure.by);
    distinct.insert(std::to_string(failure.world.index) + " " + failure.row.link + " " + failure.row.object);
    EXPECT_TRUE(event.happened(failure.row));
    EXPECT_GE(failure.times, 1u);
    EXPECT_EQ(failure.world.moves == nullptr, failure.by == "crude");
  }
  EXPECT_EQ(distinct.size(), broken.failures.size());
  EXPECT_TRUE(by.contains("splitting"));

  // Held to the frozen set, the controller fails in every world.
  folder_.write("found.jsonl", worlds);
  Suite held = load_suite(path("rare.yaml"), {{"worlds", "{frozen: " + path("found.jsonl").string() + "}"},
                                              {"trials", std::to_string(broken.failures.size())}});
  for (std::size_t i = 0; i < broken.failures.size(); ++i) {
    const SuitePoint& point = held.points.front();
    const TrialRow row = run_trial(point, point.worlds.make(point.robot->model, i)).row;
    EXPECT_TRUE(event.happened(row));
    EXPECT_EQ(row.clearance_min_m, broken.failures[i].row.clearance_min_m);
  }
  request.threads = 1;
  request.file = path("break.db");
  const Broken again = break_suite(request, suite, event);
  ASSERT_EQ(again.failures.size(), broken.failures.size());
  EXPECT_EQ(to_json(again.failures.back().world).dump(), to_json(broken.failures.back().world).dump());
  EXPECT_THROW(break_suite(request, held, event), RunError);

  // The store has the same failures as a suite of their own, with motions to play.
  const store::QueryResult found = store::query(path("break.db"),
                                                "SELECT t.clearance_min_m, x.key IS NOT NULL FROM point_trial AS m "
                                                "JOIN trial AS t USING (key) LEFT JOIN samples AS x "
                                                "USING (key) WHERE m.point_id IN (SELECT p.id FROM point AS p JOIN "
                                                "suite AS s ON s.id = p.suite_id WHERE s.name = "
                                                "'rare-found') ORDER BY m.world_index");
  ASSERT_EQ(found.rows.size(), again.failures.size());
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    EXPECT_EQ(std::get<double>(found.rows[i][0]), again.failures[i].row.clearance_min_m);
    EXPECT_EQ(std::get<std::int64_t>(found.rows[i][1]), again.failures[i].row.outcome == Outcome::kSuccess ? 0 : 1);
  }
}

/// Trials of a controller that sees no objects, some of which drive into one.
class Shrinks : public Rare {
 protected:
  Shrinks() {
    folder_.write("controllers/blind.yaml", "lambda_q: 0.01\nservo: {position: 1.5}\ncollision: {enabled: false}\n");
    suite_ = evaluated("blind",
                       "controllers: {blind: controllers/blind.yaml}\n"
                       "worlds: {seed: 3, families: {clutter: {objects: 9}}}\n"
                       "simulation: {mode: kinematic, time_limit: 3}\n"
                       "success: {position: 0.3, orientation: 3.1}\n"
                       "disturbances: {objects: {noise: {position: 0.03}, sensor: [0, 0, 1], range: 3}, "
                       "joints: {noise: 0.002}}\ntrials: 60\n");
  }

  /// Runs a suite of the tiny robot; its trials are in NAME.db.
  Suite evaluated(const std::string& name, const std::string& rest) {
    Suite suite = load_suite(folder_.write(name + ".yaml", "name: " + name + "\nrobot: robots/tiny.yaml\n" + rest));
    EvaluateRequest request;
    request.file = path((name + ".db").c_str());
    evaluate(request, suite);
    return suite;
  }
  ShrinkRequest asked(const std::string& name, const std::string& trial) const {
    ShrinkRequest request;
    request.file = path((name + ".db").c_str());
    request.trial = trial;
    return request;
  }

  /// The keys of trials that did, or did not, end by a contact with an object.
  std::vector<std::string> trials(bool contact) const {
    std::vector<std::string> out;
    const store::Reader reader(path("blind.db"));
    for (const std::string& key : reader.keys()) {
      const TrialRow row = reader.trial(key).row;
      const bool hit = row.outcome == Outcome::kCollision && row.object != "floor" && !row.object.starts_with("self:");
      if (hit == contact) out.push_back(key);
    }
    return out;
  }
  Shrunk shrunk(const std::string& trial, int threads) const {
    ShrinkRequest request = asked("blind", trial);
    request.noises = 3;
    request.threads = threads;
    return shrink(request);
  }

  /// Takes each object but the touched one away: the failure has to become rarer.
  static void expect_all_needed(SuitePoint point, const Shrunk& small) {
    point.disturbances = read_disturbances(config::node_from_json(small.disturbances, "disturbances"), "disturbances");
    for (std::size_t i = 0; i < small.world.objects.size(); ++i) {
      World less = small.world;
      if (less.objects[i].name == small.row.object) continue;
      less.objects.erase(less.objects.begin() + static_cast<std::ptrdiff_t>(i));
      int failing = 0;
      for (int k = 0; k < small.noises; ++k) {
        less.moves = k == 0 ? nullptr : noise_drawn_again(k);
        const TrialRow row = run_trial(point, less).row;
        failing += row.outcome == small.row.outcome && row.object == small.row.object ? 1 : 0;
      }
      EXPECT_LT(failing, small.failing) << small.sentence;
    }
  }

  Suite suite_;
};

TEST_F(Shrinks, ToTheObjectThatIsHitAndFailsInTheSameWay) {
  const std::vector<std::string> hits = trials(true);
  ASSERT_GE(hits.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const TrialRow before = store::Reader(path("blind.db")).trial(hits[i]).row;
    const Shrunk small = shrunk(hits[i], 2);
    // What sees nothing is disturbed by nothing that it could see: the object alone is in its way.
    ASSERT_EQ(small.world.objects.size(), 1u);
    EXPECT_EQ(small.objects_before, 9u);
    EXPECT_EQ(small.world.objects.front().name, before.object);
    EXPECT_TRUE(small.disturbances.empty()) << small.disturbances;
    EXPECT_EQ(small.failing, small.noises);
    EXPECT_EQ(small.row.outcome, Outcome::kCollision);
    EXPECT_NE(small.sentence.find("1 of 9 objects and no disturbance"), std::string::npos) << small.sentence;
    EXPECT_FALSE(small.changed.empty());

    // As a frozen world of the suite it fails, and without its object it does not.
    SuitePoint point = suite_.points.front();
    point.disturbances = {};
    World again = world_from_json(nlohmann::ordered_json::parse(to_json(small.world).dump()), "again");
    EXPECT_EQ(again.objects.front().noise, small.world.objects.front().noise);
    const TrialRow row = run_trial(point, again).row;
    EXPECT_EQ(row.object, before.object);
    EXPECT_EQ(row.time_end_s, small.row.time_end_s);
    again.objects.clear();
    EXPECT_NE(run_trial(point, again).row.outcome, Outcome::kCollision);
  }
  EXPECT_EQ(to_json(shrunk(hits.front(), 1).world).dump(), to_json(shrunk(hits.front(), 3).world).dump());
}

/// Objects that are believed to be where they are not.
TEST_F(Shrinks, ToTheDisturbanceThatMatters) {
  const Suite suite =
      evaluated("biased",
                "controllers: {plain: controllers/plain.yaml}\n"
                "worlds: {seed: 3, families: {clutter: {objects: 6}}}\n"
                "simulation: {mode: kinematic, time_limit: 4}\n"
                "disturbances: {objects: {bias: {position: 0.5}, sensor: [0, 0, 1], range: 8}, goal: {delay: 0.1}, "
                "joints: {noise: 0.0001}}\ntrials: 10\n");
  const store::Reader reader(path("biased.db"));
  int by_bias = 0, all = 0;
  for (const std::string& key : reader.keys()) {
    if (reader.trial(key).row.outcome != Outcome::kCollision) continue;
    ShrinkRequest request = asked("biased", key);
    request.noises = 2;
    request.threads = 1;
    const Shrunk small = shrink(request);
    ++all;
    request.threads = 3;
    const Shrunk again = shrink(request);
    EXPECT_EQ(to_json(again.world).dump(), to_json(small.world).dump());
    EXPECT_EQ(again.trials, small.trials);
    request.noises = 8;
    const Shrunk of_eight = shrink(request);
    EXPECT_LT(of_eight.trials, 150u);
    for (const Shrunk& one : {small, of_eight}) expect_all_needed(suite.points.front(), one);
    if (small.on != std::vector<std::string>{"objects.bias.position"}) continue;
    ++by_bias;
    EXPECT_NE(small.sentence.find("no disturbance but objects.bias.position"), std::string::npos) << small.sentence;
    EXPECT_EQ(small.disturbances["objects"]["bias"]["position"], 0.5);
    EXPECT_FALSE(small.disturbances["objects"].contains("range"));
  }
  EXPECT_GE(all, 3);
  EXPECT_GE(by_bias, all - 1);
}

// Goals after the one on whose way it failed go, and those before it where it fails without them.
TEST_F(Shrinks, ToTheGoalOnWhoseWayItFailed) {
  evaluated("several",
            "controllers: {blind: controllers/blind.yaml}\n"
            "worlds: {seed: 3, families: {sequence: {objects: 9}}}\n"
            "simulation: {mode: kinematic, time_limit: 8}\n"
            "success: {position: 0.3, orientation: 3.1}\ntrials: 20\n");
  const store::Reader reader(path("several.db"));
  int hits = 0;
  for (const std::string& key : reader.keys()) {
    const TrialRow before = reader.trial(key).row;
    if (before.outcome != Outcome::kCollision || before.object == "floor" || before.object.starts_with("self:"))
      continue;
    const Shrunk small = shrink(asked("several", key));
    ++hits;
    // A smaller world may fail on the way to a later goal than the whole one.
    EXPECT_LE(static_cast<double>(small.world.further.size()), std::max(before.goals_reached, small.row.goals_reached))
        << key;
    EXPECT_TRUE(goal_of(small.world, small.world.further.size()).stop);
    EXPECT_EQ(small.row.object, before.object);
    if (hits == 4) break;
  }
  EXPECT_GE(hits, 2);
}

// A held object stays in the hand as the start moves; if it goes, so does each goal that takes or leaves it.
TEST_F(Shrinks, WithTheObjectInTheHand) {
  nlohmann::ordered_json world = to_json(suite_.points.front().worlds.make(suite_.points.front().robot->model, 0));
  const auto ball = [](const char* name, double x, double y, double z) {
    return nlohmann::ordered_json{{"name", name}, {"shape", "sphere"}, {"size", {0.05}}, {"position", {x, y, z}}};
  };
  world["start"] = {{"base", {0, 0, 0}}, {"q", {0, 0, 0}}};
  world["goal"] = {{"position", {4.0, 0, 0.5}}, {"quaternion", {1, 0, 0, 0}}};
  world["objects"] = {ball("idle", 0, 3, 1), ball("cup", 1.0, 0, 0.2), ball("wall", 3.2, 0, 0.2)};
  world["held"] = {{"object", "cup"}};
  nlohmann::ordered_json hit = world;
  hit["objects"] = {ball("idle", 0, 3, 1), ball("cup", 1.0, 0, 0.2), ball("post", 3.2, 0, 0.5)};
  nlohmann::ordered_json takes = hit;
  takes.erase("held");
  takes.erase("goal");
  takes["goals"] = {hit["goal"], hit["goal"]};
  takes["goals"][0]["take"] = "cup";
  takes["goals"][0]["position"] = {1.0, 0, 0.5};
  folder_.write("held.jsonl", world.dump() + "\n" + hit.dump() + "\n" + takes.dump() + "\n");
  const Suite held = evaluated("held",
                               "controllers: {blind: controllers/blind.yaml}\n"
                               "worlds: {frozen: held.jsonl}\n"
                               "simulation: {mode: kinematic, time_limit: 8}\n"
                               "success: {position: 0.1, orientation: 3.1}\ntrials: 3\n");
  const store::Reader reader(path("held.db"));
  int by_cup = 0, by_arm = 0;
  for (const std::string& key : reader.keys()) {
    const Shrunk small = shrink(asked("held", key));
    const World again = world_from_json(nlohmann::ordered_json::parse(to_json(small.world).dump()), "again");
    EXPECT_FALSE(carries(again) && !again.held) << small.sentence;
    if (small.row.object == "wall") {
      ++by_cup;
      EXPECT_EQ(small.row.link, "carried:cup");
      ASSERT_EQ(again.objects.size(), 2U) << small.sentence;
      Kinematics kinematics(held.points.front().robot->model);
      kinematics.update(again.start.base, again.start.q);
      const Vector3 in_hand = kinematics.X_WE().inverse() * again.objects[0].X_WO.translation();
      EXPECT_NEAR((in_hand - Vector3(0.1, 0, -0.3)).norm(), 0.0, 0.15) << in_hand.transpose();
      EXPECT_GT(again.start.base.x(), 0.1) << "it starts later";
    } else {
      ++by_arm;
      EXPECT_EQ(small.row.object, "post");
      EXPECT_EQ(again.objects.size(), 1U) << small.sentence;
      EXPECT_FALSE(carries(again));
    }
  }
  EXPECT_EQ(by_cup, 1);
  EXPECT_EQ(by_arm, 2);
}

TEST_F(Shrinks, OnlyWhatFailed) {
  for (const std::string& key : trials(false)) {
    if (store::Reader(path("blind.db")).trial(key).row.outcome != Outcome::kSuccess) continue;
    EXPECT_THROW(shrunk(key, 1), RunError);
    return;
  }
  FAIL() << "no trial succeeds";
}

TEST_F(Shrinks, AStopLeavesAWorldThatFails) {
  const std::atomic<bool> stop = true;
  ShrinkRequest request;
  request.file = path("blind.db");
  request.trial = trials(true).front();
  request.stop = &stop;
  const Shrunk small = shrink(request);
  EXPECT_EQ(small.end, End::kStopped);
  EXPECT_EQ(small.world.objects.size(), 9u);
  EXPECT_EQ(small.row.outcome, Outcome::kCollision);
  EXPECT_GE(small.failing, 1);
}

}  // namespace
}  // namespace moma::run
