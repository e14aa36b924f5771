// The predicted state is the state that is reached: a robot is driven with late drives and late sensors, in fine steps
// that share no code with the predictor.

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "controller/safe/predictor.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"

namespace moma {
namespace {

using namespace test;

// Drives of a robot that are so many periods late, and measurements of so many periods ago.
struct Lateness {
  int base_drive = 0, joint_drive = 0, base_sensing = 0, joint_sensing = 0;
};

class LateRobot {
 public:
  LateRobot(const RobotModel& model, const Lateness& late, const Vector3& base, const VectorX& q,
            const BaseRamp::Shares& shares = {}, const Vector3& gains = Vector3::Ones())
      : model_(model), late_(late), shares_(shares), gains_(gains) {
    state_.base = base;
    state_.q = q;
    state_.qdot = VectorX::Zero(model.num_velocities());
    past_.push_front(state_);
  }

  const Observation& state() const { return state_; }
  /// The base drives with another share of its accelerations from now on, and turns as before.
  void slip(double share) { slip_ = share; }
  Observation measured() const {
    Observation o = old(late_.joint_sensing);
    const Observation& base = old(late_.base_sensing);
    o.base = base.base;
    o.qdot.head(model_.base_dof()) = base.qdot.head(model_.base_dof());
    return o;
  }
  void drive(const VectorX& sent) {
    sent_.push_front(sent);
    const int dof = model_.base_dof();
    const VectorX base = gains_.head(dof).cwiseProduct(late(late_.base_drive).head(dof));
    const VectorX joints = late(late_.joint_drive);
    constexpr int kSteps = 400;
    const double h = kPeriod / kSteps;
    for (int k = 0; k < kSteps && dof > 0; ++k) {
      VectorX change = base.head(dof) - state_.qdot.head(dof);
      const VectorX now = state_.qdot.head(dof);
      const auto share = [&](double falls) { return falls < 0.0 ? shares_.slowing : shares_.speeding; };
      const double most =
          slip_ * share(now.head(dof - 1).dot(change.head(dof - 1))) * model_.base.max_acceleration.x() * h;
      const double linear = change.head(dof - 1).norm();
      if (linear > most) change.head(dof - 1) *= most / linear;
      const double turn = share(now[dof - 1] * change[dof - 1]) * model_.base.max_acceleration.y() * h;
      change[dof - 1] = std::min(std::max(change[dof - 1], -turn), turn);
      const VectorX before = state_.qdot.head(dof);
      state_.qdot.head(dof) += change;
      const VectorX v = 0.5 * (before + state_.qdot.head(dof));
      const double phi = state_.base.z() + 0.5 * h * v[dof - 1];
      const double vy = dof == 3 ? v[1] : 0.0;
      state_.base +=
          h * Vector3(v[0] * std::cos(phi) - vy * std::sin(phi), v[0] * std::sin(phi) + vy * std::cos(phi), v[dof - 1]);
    }
    state_.qdot.tail(state_.q.size()) = joints.tail(state_.q.size());
    state_.q += kPeriod * joints.tail(state_.q.size());
    past_.push_front(state_);
  }

 private:
  const Observation& old(int periods) const {
    return past_[std::min(static_cast<std::size_t>(periods), past_.size() - 1)];
  }
  VectorX late(int periods) const {
    const auto k = static_cast<std::size_t>(periods);
    return k < sent_.size() ? sent_[k] : VectorX(VectorX::Zero(model_.num_velocities()));
  }

  const RobotModel& model_;
  Lateness late_;
  BaseRamp::Shares shares_;
  double slip_ = 1.0;
  Vector3 gains_;  // velocity / command
  Observation state_;
  std::deque<Observation> past_;
  std::deque<VectorX> sent_;
};

PredictionParams known(const Lateness& late) {
  PredictionParams p;
  p.enabled = true;
  p.base_drive = late.base_drive * kPeriod;
  p.joint_drive = late.joint_drive * kPeriod;
  p.base_sensing = late.base_sensing * kPeriod;
  p.joint_sensing = late.joint_sensing * kPeriod;
  return p;
}

constexpr Lateness kCases[] = {{}, {3, 1, 1, 0}, {0, 4, 0, 2}, {2, 5, 1, 3}, {4, 0, 0, 1}, {3, 3, 2, 0}};

TEST(Predictor, SeesTheStateThatIsReached) {
  Rng rng(1);
  for (const auto& model : built_robots()) {
    for (const Lateness& late : kCases) {
      Predictor predictor(*model, known(late), {}, 0.0, kPeriod);
      predictor.reset({});
      LateRobot robot(*model, late, Vector3(0.3, -0.2, 1.0), random_joints(*model, rng));
      const int acts = std::max(model->base_dof() > 0 ? late.base_drive : 0, late.joint_drive);
      EXPECT_NEAR(predictor.lateness(), acts * kPeriod, 1e-12);
      std::deque<Observation> predicted;
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      const VectorX target_scale = 0.5 * model->velocity_limits();
      for (int k = 0; k < 120; ++k) {
        predicted.push_front(predictor.predict(robot.measured()));
        if (predicted.size() > static_cast<std::size_t>(acts)) {
          const Observation& p = predicted[static_cast<std::size_t>(acts)];
          // The mean velocity along an arc stands for the ramp: no more than a v omega T^2 a period.
          EXPECT_LT((p.base - robot.state().base).norm(), 2e-3) << model->name << " step " << k;
          EXPECT_LT(std::abs(p.base.z() - robot.state().base.z()), 1e-4) << model->name << " step " << k;
          EXPECT_LT((p.q - robot.state().q).norm(), 1e-9) << model->name << " step " << k;
          EXPECT_LT((p.qdot - robot.state().qdot).norm(), 1e-9) << model->name << " step " << k;
        }
        // Jumps that no drive follows within a period, too.
        if (k % 7 == 0)
          command =
              target_scale.cwiseProduct(VectorX::NullaryExpr(command.size(), [&] { return uniform(rng, -1, 1); }));
        predictor.send(command, sent);
        robot.drive(sent);
      }
    }
  }
}

// A drive that follows with a part of what its file says, told from one that does by its measured, noisy velocity.
TEST(Predictor, FindsHowTheBasesDriveFollows) {
  constexpr BaseRamp::Shares kDrives[] = {{1.0, 1.0}, {1.0, 0.5}, {1.0, 0.75}, {0.5, 0.5}, {1.0, 0.33}};
  constexpr Lateness kLate{3, 1, 1, 0};
  for (const auto& model : {frankie(), mecanum()}) {
    for (const BaseRamp::Shares& drive : kDrives) {
      Rng rng(4);
      std::normal_distribution<double> noise(0.0, 0.01);
      PredictionParams params = known(kLate);
      params.identify = true;
      Predictor predictor(*model, params, {}, 0.0, kPeriod);
      predictor.reset({});
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      const auto to_and_fro = [&](const BaseRamp::Shares& shares) {
        LateRobot robot(*model, kLate, Vector3::Zero(), model->ready, shares);
        for (int k = 0; k < 400; ++k) {
          Observation o = robot.measured();
          for (int i = 0; i < model->base_dof(); ++i) o.qdot[i] += noise(rng);
          predictor.predict(o);
          if (k % 50 == 0) command[0] = k % 100 == 0 ? 0.6 : 0.0;
          predictor.send(command, sent);
          robot.drive(sent);
        }
      };
      to_and_fro(drive);
      EXPECT_NEAR(predictor.drive().slowing, drive.slowing, 0.03) << model->name;
      EXPECT_NEAR(predictor.drive().speeding, drive.speeding, 0.01) << model->name;
      Predictor again(*model, params, {}, 0.0, kPeriod);
      again.reset({});
      again.set_memory(predictor.memory());
      EXPECT_EQ(again.drive().slowing, predictor.drive().slowing);
      to_and_fro({});
      EXPECT_EQ(predictor.drive().speeding, 1.0) << model->name;
      EXPECT_NEAR(predictor.drive().slowing, drive.slowing, 0.03) << model->name << ": the least that was found";
      predictor.reset({});
      EXPECT_EQ(predictor.drive().slowing, 1.0);
    }
  }
}

// A base that is late by a part of a period, along a trapezoid of the file's acceleration: it is no slow one.
TEST(Predictor, TakesNoBaseForSlowThatIsLateByAPartOfAPeriod) {
  for (const auto& model : {frankie(), mecanum()}) {
    for (const double part : {0.0, 0.3, 0.5, 0.8}) {
      PredictionParams params = known({3, 1, 1, 0});
      params.identify = true;
      Predictor predictor(*model, params, {}, 0.0, kPeriod);
      predictor.reset({});
      Observation o;
      o.base.setZero();
      o.q = model->ready;
      o.qdot = VectorX::Zero(model->num_velocities());
      VectorX command = o.qdot, sent = o.qdot, before = o.qdot;
      const double step = 0.95 * kPeriod * model->base.max_acceleration.x();
      for (int k = 0; k < 100; ++k) {
        predictor.predict(o);
        command[0] = std::clamp(command[0] + (k < 60 ? step : -step), 0.0, 0.9);
        before = sent;
        predictor.send(command, sent);
        o.qdot[0] = (1.0 - part) * sent[0] + part * before[0];
        o.base.x() += kPeriod * o.qdot[0];
        o.time += kPeriod;
        ASSERT_EQ(predictor.drive().slowing, 1.0) << model->name << ", step " << k << ", " << part << " of a period";
      }
      EXPECT_EQ(predictor.drive().speeding, 1.0);
    }
  }
}

// A base with a third of its accelerations, asked for what its file says: commands that start from the predicted
// velocity run ahead of the base without the observer.
TEST(Predictor, CommandsStartFromWhatASlowBaseDoes) {
  constexpr Lateness kLate{3, 1, 1, 0};
  for (const auto& model : {frankie(), mecanum()}) {
    const int turn = model->base_dof() - 1;
    const double linear = 0.8 * kPeriod * model->base.max_acceleration.x(),
                 angular = 0.8 * kPeriod * model->base.max_acceleration.y();
    double ahead[2][2]{};
    for (const bool observes : {false, true}) {
      Rng rng(4);
      std::normal_distribution<double> noise(0.0, 0.01);
      PredictionParams params = known(kLate);
      if (!observes) params.estimation.observe = 0.0;
      Predictor predictor(*model, params, {}, 0.0, kPeriod);
      predictor.reset({});
      LateRobot robot(*model, kLate, Vector3::Zero(), model->ready, {1.0 / 3.0, 1.0 / 3.0});
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      for (int k = 0; k < 15; ++k) {
        Observation o = robot.measured();
        for (int i = 0; i <= turn; ++i) o.qdot[i] += noise(rng);
        const VectorX now = predictor.predict(o).qdot;
        command[0] = std::min(now[0] + linear, 1.0);
        command[turn] = std::min(now[turn] + angular, 2.0);
        predictor.send(command, sent);
        robot.drive(sent);
      }
      ahead[observes][0] = command[0] - robot.state().qdot[0];
      ahead[observes][1] = command[turn] - robot.state().qdot[turn];
    }
    for (const int way : {0, 1}) {
      EXPECT_GT(ahead[0][way], 0.0) << model->name;
      EXPECT_LT(ahead[1][way], 0.75 * ahead[0][way]) << model->name << (way == 0 ? " driving" : " turning");
    }
  }
}

// A base that slips as it brakes, after it has sped up as its file says, while its turn follows: no ramp is like that.
// Half of what it loses is believed within 0.3 s, as slip and neither as lateness nor, where it slips as it speeds up,
// as a gain.
TEST(Predictor, BelievesABaseThatSlipsAtOnce) {
  constexpr Lateness kLate{3, 1, 1, 0};
  for (const auto& model : {frankie(), mecanum()}) {
    for (const double share : {1.0, 0.5, 0.35}) {
      Rng rng(4);
      std::normal_distribution<double> noise(0.0, 0.01);
      PredictionParams params = known(kLate);
      params.identify = true;
      params.estimation.gain = 0.02;
      Predictor predictor(*model, params, {}, 0.8, kPeriod);
      predictor.reset({});
      LateRobot robot(*model, kLate, Vector3::Zero(), model->ready);
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      const int turn = model->base_dof() - 1;
      const double step = 0.8 * kPeriod * model->base.max_acceleration.x(),
                   turn_step = 0.8 * kPeriod * model->base.max_acceleration.y();
      const auto move = [&](int periods, double wanted) {
        for (int k = 0; k < periods; ++k) {
          Observation o = robot.measured();
          for (int i = 0; i < model->base_dof(); ++i) o.qdot[i] += noise(rng);
          const VectorX now = predictor.predict(o).qdot;
          command[0] = std::clamp(wanted, now[0] - step, now[0] + step);
          command[turn] = std::clamp(k % 30 < 15 ? 0.5 : -0.5, now[turn] - turn_step, now[turn] + turn_step);
          predictor.send(command, sent);
          robot.drive(sent);
        }
      };
      move(80, 0.9);
      EXPECT_EQ(predictor.drive().slowing, 1.0) << model->name;
      const double round_trip = predictor.base_round_trip();
      robot.slip(share);
      move(15 + kLate.base_drive + kLate.base_sensing, 0.0);
      EXPECT_LE(predictor.drive().slowing, 0.5 * (1.0 + share)) << model->name << ", " << share;
      EXPECT_GE(predictor.drive().slowing, share - 0.1) << model->name << ", " << share;
      EXPECT_EQ(predictor.base_round_trip(), round_trip) << model->name << ", " << share;
      robot.slip(1.0);
      move(80, 0.0);
      robot.slip(share);
      move(65, 0.9);
      robot.slip(1.0);
      move(20, 0.5);
      EXPECT_NEAR(robot.state().qdot[0], 0.5, 0.005) << model->name << ", " << share << ": the gain is 1 as before";
    }
  }
}

// A base that drives and turns by another factor than it is told, measured with noise: commands allow for it, so that
// it moves as was asked, and predictions are right.
TEST(Predictor, FindsTheBasesGains) {
  constexpr Lateness kLate{3, 1, 1, 0};
  const Vector3 gains(0.92, 1.1, 0.95);
  for (const auto& model : {frankie(), mecanum()}) {
    for (const double spread : {0.1, 0.0}) {
      Rng rng(4);
      std::normal_distribution<double> noise(0.0, 0.01);
      PredictionParams params = known(kLate);
      params.identify = true;
      params.estimation.gain = spread;
      params.base_filter = 0.1;  // adds up errors of the prediction
      Predictor predictor(*model, params, {}, 0.0, kPeriod);
      predictor.reset({});
      LateRobot robot(*model, kLate, Vector3::Zero(), model->ready, {}, gains);
      const int dof = model->base_dof();
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      std::deque<Observation> predicted;
      double off_velocity = 0.0, off_place = 0.0;
      for (int k = 0; k < 500; ++k) {
        Observation o = robot.measured();
        for (int i = 0; i < dof; ++i) o.qdot[i] += noise(rng);
        predicted.push_front(predictor.predict(o));
        if (k > 350) {
          const Observation& then = predicted[static_cast<std::size_t>(kLate.base_drive)];
          off_place = std::max(off_place, (then.base - robot.state().base).norm());
          if (k % 100 > 70) off_velocity = std::max(off_velocity, (robot.state().qdot - command).head(dof).norm());
        }
        if (k % 100 == 0) command.head(dof) = (k % 200 == 0 ? 0.4 : -0.3) * VectorX::Ones(dof);
        predictor.send(command, sent);
        robot.drive(sent);
      }
      if (spread > 0.0) {
        EXPECT_LT(off_velocity, 0.004) << model->name << " [m/s, rad/s]";
        EXPECT_LT(off_place, 0.0015) << model->name << " [m, rad]";
      } else {  // the test can fail
        EXPECT_GT(off_velocity, 0.02) << model->name;
      }
    }
  }
}

// A command that the base's speeds do not allow is not sent, whatever the gain.
TEST(Predictor, SendsNoMoreThanTheBasesSpeeds) {
  const auto model = frankie();
  PredictionParams params = known({});
  params.identify = true;
  params.estimation.gain = 0.1;
  Predictor predictor(*model, params, {}, 0.0, kPeriod);
  predictor.reset({});
  LateRobot robot(*model, {}, Vector3::Zero(), model->ready, {}, {0.9, 0.9, 1.0});
  const VectorX most = model->velocity_limits();
  VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
  command.head(2) = most.head(2);
  for (int k = 0; k < 300; ++k) {
    predictor.predict(robot.measured());
    predictor.send(command, sent);
    for (int i = 0; i < 2; ++i) ASSERT_LE(sent[i], most[i]) << "step " << k;
    robot.drive(sent);
  }
  EXPECT_NEAR(predictor.velocity()[0], 0.9 * most[0], 0.01 * most[0]);  // it knows what the base does
}

// Without the predictor's knowledge the error would be that of the commands on their way: the test above can fail.
TEST(Predictor, WrongLatenessIsSeenInTheError) {
  const auto model = frankie();
  Predictor predictor(*model, known({}), {}, 0.0, kPeriod);
  predictor.reset({});
  LateRobot robot(*model, {3, 1, 1, 0}, Vector3::Zero(), model->ready);
  VectorX command = VectorX::Zero(9), sent = command;
  command[0] = 0.5;
  double worst = 0.0;
  for (int k = 0; k < 40; ++k) {
    worst = std::max(worst, (predictor.predict(robot.measured()).base - robot.state().base).norm());
    predictor.send(command, sent);
    robot.drive(sent);
  }
  EXPECT_GT(worst, 9e-3);
}

TEST(Predictor, FindsLatenessThatNobodyToldIt) {
  Rng rng(2);
  for (const auto& model : built_robots()) {
    for (const Lateness& late : kCases) {
      PredictionParams params = known({1, 2, 1, 0});
      params.identify = true;
      Predictor predictor(*model, params, {}, 0.0, kPeriod);
      predictor.reset({});
      LateRobot robot(*model, late, Vector3::Zero(), model->ready);
      VectorX command = VectorX::Zero(model->num_velocities()), sent = command;
      for (int k = 0; k < 250; ++k) {
        Observation o = robot.measured();
        std::normal_distribution<double> noise(0.0, 0.005);
        for (double& v : o.qdot) v += noise(rng);
        predictor.predict(o);
        if (k % 10 == 0) command = 0.3 * VectorX::NullaryExpr(command.size(), [&] { return uniform(rng, -1, 1); });
        predictor.send(command, sent);
        robot.drive(sent);
      }
      if (model->base_dof() > 0) {
        EXPECT_NEAR(predictor.base_round_trip(), (late.base_drive + late.base_sensing) * kPeriod, 1e-12)
            << model->name << " base " << late.base_drive << "+" << late.base_sensing;
      }
      EXPECT_NEAR(predictor.joint_round_trip(), (late.joint_drive + late.joint_sensing) * kPeriod, 1e-12)
          << model->name << " joints " << late.joint_drive << "+" << late.joint_sensing;
    }
  }
}

// The joints wait for a base that is believed to be late. As it turns out not to be, commands that wait are left out:
// what is sent still changes no faster than the joints may.
TEST(Predictor, CatchesUpWithinTheLimitsWhereAWaitBecomesShorter) {
  const auto model = frankie();
  PredictionParams params = known({6, 0, 0, 0});
  params.identify = true;
  const VectorX limit = VectorX::Constant(model->num_velocities(), 5.0);
  for (const bool limited : {true, false}) {
    Predictor predictor(*model, params, {}, 0.0, kPeriod, limited ? limit : VectorX());
    predictor.reset({});
    LateRobot robot(*model, {}, Vector3::Zero(), model->ready);
    VectorX command = VectorX::Zero(model->num_velocities()), sent = command, before = command;
    const double step = 5.0 * kPeriod;
    double largest = 0.0, lateness = predictor.lateness();
    bool shorter = false;
    for (int k = 0; k < 200; ++k) {
      predictor.predict(robot.measured());
      shorter = shorter || predictor.lateness() < lateness;
      lateness = predictor.lateness();
      // To and fro as fast as allowed, then still.
      const double to = k < 150 && k / 7 % 2 == 0 ? 0.5 : k < 150 ? -0.5 : 0.0;
      for (double& u : command) u += std::clamp(to - u, -step, step);
      predictor.send(command, sent);
      largest = std::max(largest, (sent - before).tail(7).cwiseAbs().maxCoeff());
      before = sent;
      robot.drive(sent);
    }
    EXPECT_TRUE(shorter);
    EXPECT_NEAR(predictor.lateness(), 0.0, 1e-12);
    EXPECT_EQ(sent.tail(7), command.tail(7)) << "it has caught up";
    if (limited) {
      EXPECT_LE(largest, step * (1.0 + 1e-9));
    } else {
      EXPECT_GT(largest, 1.5 * step) << "nothing was left out: this shows nothing";
    }
  }
}

TEST(Predictor, MovesOnWhatMoves) {
  PredictionParams params = known({3, 1, 1, 0});
  params.object_sensing = 0.08;
  params.goal_sensing = 0.04;
  const auto model = frankie();
  Predictor predictor(*model, params, {}, 0.0, kPeriod);
  predictor.reset(std::vector<ObjectShape>(3));
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  o.objects.resize(3);
  o.objects[0].V_WO_W << 0, 0, 1.0, 0.5, 0, 0;
  o.objects[1].X_WO.translation() << 1, 2, 3;
  o.objects[2].visible = false;
  o.goal.V_WG_W << 0, 0, 0, 0, 0.2, 0;
  const Observation& p = predictor.predict(o);
  EXPECT_NEAR(p.objects[0].X_WO.translation().x(), 0.5 * (0.08 + 0.06), 1e-12);
  EXPECT_NEAR(log_so3(p.objects[0].X_WO.linear()).z(), 0.14, 1e-12);
  EXPECT_EQ(p.objects[1].X_WO.translation(), Vector3(1, 2, 3));
  EXPECT_FALSE(p.objects[2].visible);
  EXPECT_NEAR(p.goal.X_WG.translation().y(), 0.2 * (0.04 + 0.06), 1e-12);
}

// Headings that are measured wrapped, and a base that is put somewhere else.
TEST(Predictor, TakesWrappedHeadingsAndRelocations) {
  PredictionParams params = known({});
  params.base_filter = 0.2;
  const auto model = frankie();
  Predictor predictor(*model, params, {}, 0.0, kPeriod);
  predictor.reset({});
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  VectorX sent = VectorX::Zero(9);
  double heading = 3.0;
  for (int k = 0; k < 100; ++k, heading += 0.01) {
    o.base = Vector3(0, 0, std::remainder(heading, 2 * kPi));
    VectorX command = VectorX::Zero(9);
    command[1] = 0.5;
    const Observation& p = predictor.predict(o);
    if (k > 0) {
      EXPECT_LT(std::abs(p.base.z() - heading), 0.1) << k;
    }
    predictor.send(command, sent);
  }
  o.base = Vector3(3, 0, 0);
  EXPECT_EQ(predictor.predict(o).base, o.base);
}

TEST(Predictor, GoesOnFromWhatItRemembers) {
  Rng rng(7);
  const auto model = mecanum();
  PredictionParams params = known({2, 4, 1, 1});
  params.identify = true;
  params.base_filter = params.resting_filter = params.moving_filter = params.twist_filter = 0.1;
  Predictor first(*model, params, {}, 0.0, kPeriod), second(*model, params, {}, 0.0, kPeriod);
  first.reset(std::vector<ObjectShape>(4));
  second.reset(std::vector<ObjectShape>(4));
  VectorX sent = VectorX::Zero(model->num_velocities()), other = sent;
  for (int k = 0; k < 60; ++k) {
    Observation o = random_observation(*model, 4, rng);
    o.objects[static_cast<std::size_t>(k % 4)].V_WO_W.setZero();
    if (k % 5 == 3) o.objects[0].visible = false;
    const VectorX command = VectorX::NullaryExpr(sent.size(), [&] { return uniform(rng, -0.3, 0.3); });
    second.set_memory(first.memory());
    const Observation p = first.predict(o);
    const Observation& q = second.predict(o);
    EXPECT_EQ(p.base, q.base) << k;
    EXPECT_EQ(p.q, q.q) << k;
    EXPECT_EQ(p.qdot, q.qdot) << k;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(p.objects[i].X_WO.matrix(), q.objects[i].X_WO.matrix()) << k;
    EXPECT_EQ(p.goal.X_WG.matrix(), q.goal.X_WG.matrix()) << k;
    first.send(command, sent);
    second.send(command, other);
    EXPECT_EQ(sent, other) << k;
  }
}

// A step without a usable observation: what was sent goes on acting.
TEST(Predictor, KnowsWhereTheBaseIsAfterAStepWithoutMeasurements) {
  const auto model = frankie();
  const Lateness late{3, 1, 1, 0};
  PredictionParams params = known(late);
  params.base_filter = 1.0;  // so that the model, not the measurement, decides
  Predictor predictor(*model, params, {}, 0.0, kPeriod);
  predictor.reset({});
  LateRobot robot(*model, late, Vector3::Zero(), model->ready);
  VectorX command = VectorX::Zero(9), sent = command;
  std::deque<Observation> predicted;
  for (int k = 0; k < 60; ++k) {
    command[0] = 0.4;
    command[1] = 0.3;
    if (k % 4 == 2) {
      predictor.skip();
      predicted.push_front({});
    } else {
      predicted.push_front(predictor.predict(robot.measured()));
    }
    if (k >= 3 && (k - 3) % 4 != 2) {
      EXPECT_LT((predicted[3].base - robot.state().base).norm(), 1e-3) << k;
    }
    predictor.send(command, sent);
    robot.drive(sent);
  }
}

// Steps that nobody took, seen by the observations' time stamps: the command sent last acted through them.
TEST(Predictor, AllowsForStepsThatWereMissed) {
  const auto model = frankie();
  for (const bool stamped : {true, false}) {
    const Lateness late{3, 1, 1, 0};
    PredictionParams params = known(late);
    params.base_filter = 1.0;
    params.identify = true;
    Predictor predictor(*model, params, {}, 0.0, kPeriod);
    predictor.reset({});
    LateRobot robot(*model, late, Vector3::Zero(), model->ready);
    VectorX command = VectorX::Zero(9), sent = command;
    double worst = 0.0;
    int steps = 0;
    for (int k = 0; k < 150; ++k) {
      if (k % 5 != 2 && k % 5 != 3) {  // two of five are missed
        Observation o = robot.measured();
        o.time = stamped ? 100.0 + k * kPeriod : 100.0 + steps * kPeriod;
        ++steps;
        const Observation predicted = predictor.predict(o);
        if (k > 20 && k % 5 == 4) {
          // Without a new command the predicted place is reached: 3 periods of the last commands.
          LateRobot ahead = robot;
          VectorX wait = command, now = sent;
          Predictor copy = predictor;
          copy.send(wait, now);
          for (int i = 0; i < 3; ++i) {
            ahead.drive(now);
            copy.skip();
            copy.send(wait, now);
          }
          worst = std::max(worst, (predicted.base - ahead.state().base).norm());
          worst = std::max(worst, (predicted.q - ahead.state().q).norm());
        }
        command.setConstant(0.2 * std::sin(0.1 * k));
        command[0] = 0.5 * std::cos(0.15 * k);
        predictor.send(command, sent);
      }
      robot.drive(sent);
    }
    if (stamped) {
      EXPECT_LT(worst, 1e-3);
      EXPECT_EQ(predictor.base_round_trip(), 4 * kPeriod);
      EXPECT_GE(predictor.hold(), 2.9);
      EXPECT_LE(predictor.hold(), 3.0);
      const double forgotten = 1.0 - std::exp(-150 * kPeriod / params.estimation.missed);
      EXPECT_NEAR(predictor.drive().speeding, 1.0 - 0.4 * forgotten, 0.02);
    } else {
      EXPECT_GT(worst, 0.005) << "the test can fail";
      EXPECT_EQ(predictor.hold(), 1.0);
      EXPECT_EQ(predictor.memory().kept, 1.0);
    }
  }
}

// Stamps that are regular but for rounding and jitter, that stay, that go back, and a pause.
TEST(Predictor, TakesNoStepForMissedThatWasNot) {
  const auto model = frankie();
  Predictor predictor(*model, known({}), {}, 0.0, kPeriod);
  VectorX command = VectorX::Constant(9, 0.1), sent = command;
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  const auto hold_after = [&](const std::vector<double>& times) {
    predictor.reset({});
    for (const double t : times) {
      o.time = t;
      predictor.predict(o);
      predictor.send(command, sent);
    }
    return predictor.hold();
  };
  EXPECT_EQ(hold_after({1.7e9, 1.7e9 + 0.02, 1.7e9 + 0.04}), 1.0);
  EXPECT_EQ(hold_after({0.0, 0.027, 0.036, 0.064}), 1.0);
  EXPECT_EQ(hold_after({0.0, 0.0, 0.0}), 1.0);
  EXPECT_EQ(hold_after({5.0, 1.0, 0.0}), 1.0);
  EXPECT_EQ(hold_after({0.0, 0.02, 0.08}), 3.0);
  const double pause = hold_after({0.0, 0.02, 1e6});
  EXPECT_GT(pause, 10.0);
  EXPECT_LT(pause, 30.0);
}

}  // namespace
}  // namespace moma
