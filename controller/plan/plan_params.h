#pragma once

#include "controller/describe/describe.h"

namespace moma {

/// Looking ahead (controller/ahead): the controller predicts its own motion, and where it would stop short of the goal
/// it plans for base and arm. Work is counted in checks, each about that of one configuration's distances.
struct PlanParams {
  bool enabled = false;
  int budget = 600;            ///< checks in one control step, at most by one piece of work more
  double period = 0.5;         ///< between predictions [s]
  double horizon = 10.0;       ///< of a prediction [s]
  double step = 0.04;          ///< of a prediction [s]
  double touch = 0.005;        ///< a prediction that comes nearer to an object fails [m]
  double roomy = 0.08;         ///< clearance of a path from objects, tried first [m]
  double clearance = 0.035;    ///< and where that finds none [m]
  double self = 0.015;         ///< clearance from the robot itself and from the floor [m]
  double joint_margin = 0.12;  ///< from a path to the joints' limits [rad, m]
  double speed = 0.9;          ///< part of the greatest speeds that a path uses
  double acceleration = 0.85;  ///< and of the accelerations
  double check_step = 0.08;    ///< way of any point of the robot between two checks [m]
  double overlap = 0.35;       ///< at most, of successive motions of a path [s]
  double settle = 0.3;         ///< from a path's end to the goal [s]
  double stuck = 1.0;          ///< without progress on a path: a new one [s]
  double lag = 0.1;            ///< behind the path's clock that stops it is 1.5 of this [m]
  double weight = 10.0;        ///< of the path's velocities in the QP
  double gain = 3.0;           ///< of the path's servo [1/s]
  int ik_tries = 150;          ///< of whole-body inverse kinematics at each clearance
  int ik_enough = 24;          ///< solutions
  int roots = 10;              ///< of these that the search starts from
  int checks = 12000;          ///< of a search; half as many at the roomy clearance
  int runs = 4;                ///< of the search, each in what the best one leaves open
  int shortcuts = 60;          ///< tried, in each run
  int direct = 60;             ///< inverse kinematics for a direct way at a motion's start; 0: none is looked for
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<PlanParams>) {
  v.member("budget", &PlanParams::budget,
           in_range({1.0, 1e7}, "", "checks in one control step, at most by one piece of work more"));
  v.member("period", &PlanParams::period, positive("s", "between predictions"));
  v.member("horizon", &PlanParams::horizon, positive("s", "of a prediction"));
  v.member("step", &PlanParams::step, positive("s", "of a prediction"));
  v.member("touch", &PlanParams::touch, quantity("m", "a prediction that comes nearer to an object fails"));
  v.member("roomy", &PlanParams::roomy, non_negative("m", "clearance of a path from objects, tried first"));
  v.member("clearance", &PlanParams::clearance, non_negative("m", "clearance of a path where that finds none"));
  v.member("self", &PlanParams::self, non_negative("m", "clearance from the robot itself and from the floor"));
  v.member("joint_margin", &PlanParams::joint_margin, non_negative("rad or m", "from a path to the joints' limits"));
  v.member("speed", &PlanParams::speed,
           in_range({0.0, 1.0, true, false}, "1", "part of the greatest speeds that a path uses"));
  v.member("acceleration", &PlanParams::acceleration,
           in_range({0.0, 1.0, true, false}, "1", "part of the accelerations that a path uses"));
  v.member("check_step", &PlanParams::check_step, positive("m", "way of any point of the robot between two checks"));
  v.member("overlap", &PlanParams::overlap, non_negative("s", "of successive motions of a path, at most"));
  v.member("settle", &PlanParams::settle, non_negative("s", "from a path's end to the goal"));
  v.member("stuck", &PlanParams::stuck,
           positive("s", "time without progress on a path after which a new one is sought"));
  v.member("lag", &PlanParams::lag,
           positive("m", "the path's clock runs at clip(1.5 - lag of the robot / this, 0, 1)"));
  v.member("weight", &PlanParams::weight, positive("1", "of the path's velocities"));
  v.member("gain", &PlanParams::gain, non_negative("1/s", "of the path's servo"));
  v.member("ik_tries", &PlanParams::ik_tries,
           in_range({1.0, 1e5}, "", "of whole-body inverse kinematics at each clearance"));
  v.member("ik_enough", &PlanParams::ik_enough, in_range({1.0, 1000.0}, "", "solutions that are enough"));
  v.member("roots", &PlanParams::roots, in_range({1.0, 1000.0}, "", "of these that the search starts from"));
  v.member("checks", &PlanParams::checks, in_range({0.0, 1e7}, "", "of a search; half as many at the roomy clearance"));
  v.member("runs", &PlanParams::runs, in_range({1.0, 100.0}, "", "of the search"));
  v.member("shortcuts", &PlanParams::shortcuts, in_range({0.0, 1e5}, "", "tried in each run"));
  v.member("direct", &PlanParams::direct,
           in_range({0.0, 1e4}, "", "inverse kinematics for a direct way at a motion's start; 0: none"));
}

}  // namespace moma
