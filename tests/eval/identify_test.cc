// Logs that moma itself simulates, with latencies, ramps and noise that are known: what is found of them.
#include "eval/identify/identify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "controller/config/node.h"
#include "controller/config/read_described.h"
#include "controller/config/robot_file.h"
#include "controller/describe/equal.h"
#include "eval/identify/found_files.h"
#include "eval/identify/motion_log.h"
#include "eval/identify/response.h"
#include "eval/run/log_of_trial.h"
#include "tests/eval/trial_fixture.h"
#include "world/draws.h"
#include "world/sensing/disturbances_file.h"

namespace moma::test {
namespace {

using namespace identify;

constexpr double kPeriod = 0.02;

// Steps of all velocities: of the base at random every 0.4 s, of the joints to and fro, each in its own time.
ScriptedController::Script steps(double linear, double angular, double joint, int base_dof, int joints) {
  return [=](const Observation& o, StepResult& result) {
    const auto now = static_cast<std::uint64_t>(std::floor(o.time / 0.4 + 1e-9));
    Draws draws(11, 0, Stream::kMotion, now);
    for (int i = 0; i < base_dof; ++i) {
      const double most = i + 1 == base_dof ? angular : linear;
      result.command[i] = draws.uniform(-most, most);
    }
    for (int i = 0; i < joints; ++i) {
      const double half = 0.3 + 0.06 * i;
      result.command[base_dof + i] = std::fmod(std::floor(o.time / half + 1e-9), 2.0) < 0.5 ? joint : -joint;
    }
  };
}

// Exact but for the base's velocities, which follow no faster than so many m/s^2 and rad/s^2.
class RampedPlant final : public FakePlant {
 public:
  RampedPlant(std::shared_ptr<const RobotModel> model, const World& world, const Vector2& acceleration)
      : FakePlant(std::move(model), world), acceleration_(acceleration) {}

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    VectorX followed = command;
    for (int i = 0; i < 2; ++i) {
      const double most = acceleration_[i] * duration;
      now_[i] += std::clamp(command[i] - now_[i], -most, most);
      followed[i] = now_[i];
    }
    FakePlant::advance(followed, duration, report);
  }

 private:
  Vector2 acceleration_, now_ = Vector2::Zero();
};

MotionLog tiny_log(const Disturbances& disturbances, double seconds = 30.0, const Vector2& acceleration = {1e6, 1e6}) {
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = seconds;
  spec.disturbances = disturbances;
  World world = tiny_world(50.0);
  world.seed = 21;
  world.objects.push_back(sphere("box", {5.0, 8.0, 3.0}, 0.1));
  world.objects.push_back(sphere("post", {-6.0, 8.0, 3.0}, 0.1));
  TrialParts parts;
  parts.plant = [&](const TrialSpec& p, const World& w) {
    return std::make_unique<RampedPlant>(p.robot->model, w, acceleration);
  };
  parts.controller = [](const TrialSpec&) {
    return std::make_unique<ScriptedController>(5, steps(0.8, 1.5, 0.2, 2, 3));
  };
  return run::log_of_trial(spec, world, parts);
}

Disturbances late(int base_drive, int base_sensing, int joint_drive, int joint_sensing) {
  Disturbances d;
  d.actuators.base.delay = kPeriod * base_drive;
  d.base.delay = kPeriod * base_sensing;
  d.actuators.joints.delay = kPeriod * joint_drive;
  d.joints.delay = kPeriod * joint_sensing;
  return d;
}

Disturbances noisy(Disturbances d) {
  d.base.noise = {0.002, 0.001};
  d.base.velocity_noise = {0.01, 0.012};
  d.joints.noise = 0.0003;
  d.joints.velocity_noise = 0.005;
  d.objects.noise.position = 0.004;
  d.objects.delay = 0.08;
  return d;
}

TEST(Identify, FindsLatenciesAndTheirParts) {
  for (const Disturbances& d : {late(0, 0, 0, 0), late(3, 1, 1, 0), noisy(late(3, 1, 1, 0)), noisy(late(7, 2, 0, 4))}) {
    const Found found = identify::identify(tiny_log(d));
    ASSERT_TRUE(found.base && found.joints) << to_json(d);
    EXPECT_NEAR(found.period, kPeriod, 1e-12);
    EXPECT_NEAR(found.base->latency.round_trip, d.actuators.base.delay + d.base.delay, 1e-9) << to_json(d);
    EXPECT_NEAR(found.joints->latency.round_trip, d.actuators.joints.delay + d.joints.delay, 1e-9) << to_json(d);
    EXPECT_TRUE(found.base->latency.has_stamps);
    EXPECT_NEAR(found.base->latency.drive, d.actuators.base.delay, 1e-9);
    EXPECT_NEAR(found.base->latency.sensing, d.base.delay, 1e-9);
    EXPECT_NEAR(found.joints->latency.drive, d.actuators.joints.delay, 1e-9);
    EXPECT_NEAR(found.joints->latency.sensing, d.joints.delay, 1e-9);
    ASSERT_TRUE(found.objects && found.objects->sensing);
    EXPECT_NEAR(*found.objects->sensing, d.objects.delay, 1e-9);
  }
}

std::string refusal(const MotionLog& log) {
  try {
    (void)identify::identify(log);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Identify, RefusesWrongSignsAndUnits) {
  const auto scaled = [](std::size_t joint, std::size_t base, double factor) {
    MotionLog log = tiny_log(noisy(late(3, 2, 1, 1)));
    log.source = "drive.csv";
    for (double& v : (base < 2 ? log.base[base] : log.joints[joint]).velocity) v *= factor;
    return log;
  };
  EXPECT_NE(refusal(scaled(1, 9, -1.0)).find("times the commands: one of the two has the wrong sign"),
            std::string::npos)
      << refusal(scaled(1, 9, -1.0));
  EXPECT_EQ(refusal(scaled(1, 9, -1.0)).rfind("drive.csv: " + tiny_log({}, 3.0).joints[1].name + ": measured", 0), 0U);
  EXPECT_NE(refusal(scaled(0, 1, -1.0)).find("drive.csv: base.omega: "), std::string::npos);
  EXPECT_NE(refusal(scaled(1, 9, 57.29578)).find("one of the two is in degrees"), std::string::npos);
  EXPECT_NE(refusal(scaled(0, 1, 1.0 / 57.29578)).find("one of the two is in degrees"), std::string::npos);
  EXPECT_NE(refusal(scaled(0, 0, 1000.0)).find("are their units the same?"), std::string::npos);
  EXPECT_EQ(refusal(scaled(0, 9, 0.9)), "accepted");
  const MotionLog turned = tiny_log(noisy(late(3, 2, 1, 1)));
  for (const auto& [factor, words] :
       {std::pair{57.29578, "one of the two is in degrees"}, {-1.0, "one of the two has the wrong sign"}}) {
    MotionLog log = turned;
    for (double& phi : log.base_heading) phi *= factor;
    EXPECT_NE(refusal(log).find("base.heading: positions change"), std::string::npos) << refusal(log);
    EXPECT_NE(refusal(log).find("measured velocities: " + std::string(words)), std::string::npos) << refusal(log);
    log = turned;
    for (double& x : log.base_x) x *= 10.0 * factor;
    for (double& y : log.base_y) y *= 10.0 * factor;
    EXPECT_NE(refusal(log).find("base.x_m, base.y_m: positions change"), std::string::npos) << refusal(log);
    log = turned;
    for (double& q : log.joints[1].position) q *= factor;
    EXPECT_NE(refusal(log).find("times as fast as the measured velocities: " + std::string(words)), std::string::npos)
        << refusal(log);
  }
  const Found doubted = identify::identify(scaled(1, 9, 1.5));
  EXPECT_TRUE(std::any_of(doubted.notes.begin(), doubted.notes.end(), [](const std::string& note) {
    return note.find("1.5 times the commands") != std::string::npos;
  }));
  MotionLog degrees = turned;
  for (auto* column : {&degrees.base[1].command, &degrees.base[1].velocity, &degrees.base_heading})
    for (double& value : *column) value *= 57.29578;
  const Found fast = identify::identify(degrees);
  EXPECT_TRUE(std::any_of(fast.notes.begin(), fast.notes.end(), [](const std::string& note) {
    return note.find("base.omega: commands of up to") != std::string::npos;
  }));
}

TEST(Identify, WithoutStampsAllIsTheDrives) {
  MotionLog log = tiny_log(late(3, 2, 1, 1));
  log.base_stamp.clear();
  log.joint_stamp.clear();
  const Found found = identify::identify(log);
  EXPECT_NEAR(found.base->latency.drive, 0.1, 1e-9);
  EXPECT_EQ(found.base->latency.sensing, 0.0);
  EXPECT_FALSE(found.base->latency.has_stamps);
  EXPECT_NEAR(found.joints->latency.drive, 0.04, 1e-9);
}

TEST(Identify, FindsRampsWithinFivePerCent) {
  for (const double part : {0.25, 0.5, 0.9}) {
    for (const bool noise : {false, true}) {
      Disturbances d = late(3, 1, 1, 0);
      if (noise) d = noisy(d);
      const Found found = identify::identify(tiny_log(d, 30.0, part * Vector2(2.0, 4.0)));
      ASSERT_TRUE(found.base && found.base->linear.acceleration && found.base->turn.acceleration) << part << noise;
      EXPECT_NEAR(*found.base->linear.acceleration, part * 2.0, 0.05 * part * 2.0) << part << noise;
      EXPECT_NEAR(*found.base->turn.acceleration, part * 4.0, 0.05 * part * 4.0) << part << noise;
      EXPECT_NEAR(found.base->linear.gain, 1.0, 0.02);
      EXPECT_NEAR(found.base->latency.round_trip, 0.08, kPeriod + 1e-9) << part << noise;
    }
  }
}

TEST(Identify, SaysThatThereIsNoRampWhereCommandsAreFollowed) {
  const Found found = identify::identify(tiny_log(noisy(late(3, 1, 1, 0))));
  ASSERT_TRUE(found.base);
  EXPECT_FALSE(found.base->linear.acceleration);
  EXPECT_GT(found.base->linear.least_acceleration, 20.0) << "steps of up to 1.6 m/s in a period";
  EXPECT_EQ(std::count_if(found.notes.begin(), found.notes.end(),
                          [](const std::string& note) { return note.find("shows no ramp") != std::string::npos; }),
            2);
}

TEST(Identify, FindsNoiseWithinAFifth) {
  const Disturbances d = noisy(late(3, 1, 1, 0));
  const Found found = identify::identify(tiny_log(d, 30.0, {1.0, 2.0}));
  const auto near = [](double is, double was, const char* of) { EXPECT_NEAR(is, was, 0.2 * was) << of; };
  near(found.base->linear.velocity_noise, 0.01, "linear velocity");
  near(found.base->turn.velocity_noise, 0.012, "turning");
  near(found.base->position_noise.value(), 0.002, "place");
  near(found.base->heading_noise.value(), 0.001, "heading");
  near(found.joints->velocity_noise, 0.005, "joint velocity");
  near(found.joints->position_noise.value(), 0.0003, "joint position");
  near(found.objects->position_noise, 0.004, "objects");
  const Found clean = identify::identify(tiny_log(late(1, 0, 1, 0)));
  EXPECT_LT(clean.base->linear.velocity_noise, 1e-9);
  EXPECT_LT(clean.joints->position_noise.value(), 1e-9);
}

TEST(Noise, IsThatOfKnownDraws) {
  std::vector<double> plain, rising;
  Draws draws(1, 1, Stream::kSensing);
  for (int k = 0; k < 5000; ++k) {
    plain.push_back(draws.normal(3.0, 0.5) + (k == 2500 ? 100.0 : 0.0));
    rising.push_back(draws.normal(0.1 * k, 0.5));
  }
  EXPECT_NEAR(noise_of(plain), 0.5, 0.03);
  EXPECT_NEAR(noise_of_even_motion(rising), 0.5, 0.03);
}

// The real plant: wheels and motors of ODE, and the ramps of the robot's file.
TEST(Identify, FindsTheRampsOfTheSimulatedRobot) {
  for (const char* name : {"frankie", "frankie_omni"}) {
    TrialSpec spec;
    spec.robot = std::make_shared<config::LoadedRobot>(
        config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/" + name + ".yaml"));
    const RobotModel& model = *spec.robot->model;
    spec.simulation.mode = SimulationMode::kDynamic;
    spec.simulation.time_limit = 16.0;
    spec.disturbances = late(3, 1, 1, 0);
    spec.disturbances.base.velocity_noise = {0.01, 0.01};
    World world;
    world.family = "test";
    world.seed = 3;
    world.start.q = model.ready;
    world.goal.X_WG.translation() = Vector3(50, 0, 1);
    const int dof = model.base_dof();
    TrialParts parts;
    parts.controller = [&](const TrialSpec&) {
      return std::make_unique<ScriptedController>(model.num_velocities(),
                                                  steps(0.5, 0.8, 0.1, dof, model.num_joints()));
    };
    const MotionLog log = run::log_of_trial(spec, world, parts);
    ASSERT_GT(log.rows(), 700u) << name;
    const Found found = identify::identify(log);
    ASSERT_TRUE(found.base && found.joints) << name;
    EXPECT_NEAR(found.base->latency.round_trip, 0.08, kPeriod + 1e-9) << name;
    EXPECT_NEAR(found.joints->latency.round_trip, 0.02, kPeriod + 1e-9) << name;
    ASSERT_TRUE(found.base->linear.acceleration && found.base->turn.acceleration) << name;
    const Vector2 a = model.base.max_acceleration;
    EXPECT_NEAR(*found.base->linear.acceleration, a.x(), 0.05 * a.x()) << name;
    EXPECT_NEAR(*found.base->turn.acceleration, a.y(), 0.05 * a.y()) << name;
  }
}

TEST(MotionLog, IsReadAsItWasWritten) {
  const MotionLog log = tiny_log(noisy(late(3, 1, 1, 0)), 5.0);
  std::ostringstream out;
  write_log(out, log);
  const MotionLog back = parse_log(out.str(), "log.csv");
  EXPECT_EQ(back.time, log.time);
  EXPECT_EQ(back.base_x, log.base_x);
  EXPECT_EQ(back.base_heading, log.base_heading);
  EXPECT_EQ(back.base_stamp, log.base_stamp);
  EXPECT_EQ(back.joint_stamp, log.joint_stamp);
  ASSERT_EQ(back.base.size(), 2u);
  EXPECT_EQ(back.base[1].command, log.base[1].command);
  EXPECT_EQ(back.base[1].velocity, log.base[1].velocity);
  ASSERT_EQ(back.joints.size(), 3u);
  EXPECT_EQ(back.joints[2].name, "reach");
  EXPECT_TRUE(back.joints[2].prismatic && !back.joints[0].prismatic);
  EXPECT_EQ(back.joints[2].position, log.joints[2].position);
  ASSERT_EQ(back.objects.size(), 2u);
  EXPECT_EQ(back.objects[1].z, log.objects[1].z);
  EXPECT_EQ(back.objects[1].stamp, log.objects[1].stamp);
}

std::string error_of(const std::string& text) {
  try {
    identify::identify(parse_log(text, "log.csv"));
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "";
}

// A log of one joint whose command is `u(k)`, measured one period later.
std::string one_joint(int rows, const std::function<double(int)>& u, double period = 0.01) {
  std::string text = "time_s,joint.a.command_rad_s,joint.a.velocity_rad_s\n";
  for (int k = 0; k < rows; ++k)
    text +=
        std::to_string(period * k) + "," + std::to_string(u(k)) + "," + std::to_string(k > 1 ? u(k - 2) : 0.0) + "\n";
  return text;
}

double square_wave(int k) { return k / 20 % 2 == 0 ? 0.5 : -0.5; }

TEST(MotionLog, RefusesWhatIsWrongAndSaysWhere) {
  const std::string good = one_joint(300, square_wave);
  EXPECT_EQ(error_of(good), "");
  const auto changed = [&](int line, const std::string& text) {
    std::istringstream in(good);
    std::string out, row;
    for (int i = 1; std::getline(in, row); ++i) out += (i == line ? text : row) + "\n";
    return out;
  };
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string error = error_of(text);
    for (const std::string& word : words)
      EXPECT_NE(error.find(word), std::string::npos) << "'" << error << "' has no " << word;
  };
  expect(changed(5, "0.03,nan,0.5"), {"log.csv:5:6", "joint.a.command_rad_s", "nan", "finite"});
  expect(changed(5, "0.03,0.5,fast"), {"log.csv:5:10", "joint.a.velocity_rad_s", "fast", "number"});
  expect(changed(5, "0.03,0.5"), {"log.csv:5", "found 2 values, expected 3"});
  expect(changed(5, "0.01,0.5,0.5"), {"log.csv:5", "time_s", "grow"});
  expect(changed(5, "0.031,0.5,0.5"), {});
  expect(changed(5, "0.0399,0.5,0.5"), {"log.csv:5", "control period is 0.01"});
  expect(changed(5, ""), {"log.csv:5", "empty line"});
  expect(changed(1, "time_s,joint.a.command_rad_s,joint.a.speed"), {"log.csv:1:30", "joint.a.speed", "unknown column"});
  expect(changed(1, "time_s,joint.a.command_rad_s,joint.a.command_rad_s"), {"log.csv:1:30", "before"});
  expect(changed(1, "time_s,joint.a.command_rad_s,joint.b.velocity_rad_s"), {"joint a", "velocity"});
  expect(changed(1, "time_s,base.command_vx_m_s,base.vx_m_s"), {"omega"});
  expect(one_joint(50, square_wave), {"50 rows", "100"});
  expect(one_joint(300, [](int) { return 0.3; }), {"not identifiable", "never change"});
  expect("", {"no rows"});
  expect(std::string("SQLite format 3\0", 16), {"log.csv", "is no text"});
  // Motion that has nothing to do with the commands.
  std::string other = "time_s,joint.a.command_rad_s,joint.a.velocity_rad_s\n";
  Draws draws(5, 5, Stream::kSensing);
  for (int k = 0; k < 400; ++k)
    other += std::to_string(0.01 * k) + "," + std::to_string(square_wave(k)) + "," +
             std::to_string(draws.normal(0, 1)) + "\n";
  expect(other, {"not identifiable", "does not follow"});
  EXPECT_THROW(read_log("/nowhere/log.csv"), config::ConfigError);
  EXPECT_THROW(read_log("/dev/zero"), config::ConfigError) << "what never ends is not read";
}

TEST(FoundFiles, AreReadBackAsWhatWasFound) {
  const Disturbances d = noisy(late(3, 1, 1, 0));
  const Found found = identify::identify(tiny_log(d, 30.0, {1.0, 2.0}));
  const std::string text = disturbances_file(found, "drive.csv");
  EXPECT_NE(text.find("drive.csv"), std::string::npos);
  EXPECT_NE(text.find("max_acceleration: ["), std::string::npos) << text;
  const Disturbances back = read_disturbances(config::parse_yaml(text, "found.yaml"), "disturbances");
  EXPECT_TRUE(same(back, disturbances_of(found))) << text;
  EXPECT_NEAR(back.actuators.base.delay, 0.06, 1e-9);
  EXPECT_NEAR(back.objects.delay, 0.08, 1e-9);
  const config::Node controller = config::parse_yaml(controller_file(found, "drive.csv"), "prediction.yaml");
  PredictionParams prediction;
  config::read_described(*controller.find("prediction"), "prediction", prediction);
  EXPECT_NEAR(prediction.base_drive, 0.06, 1e-9);
  EXPECT_NEAR(prediction.base_sensing, 0.02, 1e-9);
  EXPECT_NEAR(prediction.joint_drive, 0.02, 1e-9);
  EXPECT_NEAR(prediction.object_sensing, 0.08, 1e-9);
  UncertaintyParams uncertainty;
  config::read_described(*controller.find("uncertainty"), "uncertainty", uncertainty);
  EXPECT_NEAR(uncertainty.object_noise, 0.004, 0.001);
  EXPECT_NE(summary(found).find("drive 0.06 s, sensing 0.02 s"), std::string::npos) << summary(found);
}

}  // namespace
}  // namespace moma::test
