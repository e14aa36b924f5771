// The metrics a trial may have: how the page names them and writes them.

import { fixed, significant } from './format';

export interface Metric {
  key: string;
  name: string;
  unit: string;
  /** '' where neither end is better by itself. */
  better: 'high' | 'low' | '';
  write: (value: number) => string;
}

const m = (key: string, name: string, unit: string, better: Metric['better'], write?: Metric['write']): Metric => ({
  key, name, unit, better, write: write ?? ((value) => significant(value, 3)),
});

const f = (decimals: number) => (value: number) => fixed(value, decimals);

export const kMetrics: readonly Metric[] = [
  m('time_to_goal_s', 'time to goal', 's', 'low', f(2)),
  m('time_end_s', 'end of the trial', 's', '', f(2)),
  m('position_error_m', 'final position error', 'm', 'low'),
  m('orientation_error_rad', 'final orientation error', 'rad', 'low'),
  m('manip_mean', 'manipulability, mean', '', 'high', f(4)),
  m('manip_min', 'manipulability, least', '', 'high', f(4)),
  m('manip_final', 'manipulability at the end', '', 'high', f(4)),
  m('manip_all_mean', 'six-row manipulability, mean', '', 'high', f(4)),
  m('manip_all_min', 'six-row manipulability, least', '', 'high', f(4)),
  m('manip_all_final', 'six-row manipulability at the end', '', 'high', f(4)),
  m('clearance_min_m', 'least clearance', 'm', 'high'),
  m('clearance_self_min_m', 'least clearance to itself', 'm', 'high'),
  m('limit_margin_min', 'least joint-limit margin', '', 'high'),
  m('path_ee_m', 'path of the end effector', 'm', 'low', f(2)),
  m('path_base_m', 'path of the base', 'm', 'low', f(2)),
  m('command_change_mean', 'command change, mean', '', 'low'),
  m('jerk_ee_rms', 'jerk of the end effector, RMS', 'm/s\u00b3', 'low'),
  m('jerk_joint_rms', 'jerk of the joints, RMS', 'rad/s\u00b3', 'low'),
  m('energy_j', 'energy', 'J', 'low'),
  m('slack_mean', 'slack, mean', '', 'low'),
  m('slack_max', 'slack, greatest', '', 'low'),
  m('active_rows_mean', 'active constraints, mean', '', '', f(2)),
  m('tracking_error_rms', 'tracking error, RMS', '', 'low'),
  m('slip_max_m_s', 'wheel slip, greatest', 'm/s', 'low'),
  m('collision_depth_m', 'collision depth', 'm', 'low', (value) => significant(value, 2)),
  m('collision_time_s', 'time of collision', 's', '', f(2)),
  m('collision_count', 'pairs in contact', '', 'low', f(0)),
  m('qp_infeasible', 'infeasible steps', '', 'low', f(0)),
  m('fallback_no_acceleration', 'steps without acceleration bounds', '', 'low', f(0)),
  m('fallback_relaxed', 'steps with relaxed rows', '', 'low', f(0)),
  m('fallback_brake', 'braking steps', '', 'low', f(0)),
  m('lcp_messages', 'messages of the physics solver', '', 'low', f(0)),
  m('steps', 'control steps', '', '', f(0)),
  m('detector_checks', 'states in which contacts were cross-checked', '', '', f(0)),
  m('detector_disagreements', 'disagreements of the contact detectors', '', 'low', f(0)),
  m('detector_deepest_m', 'deepest disagreement of the contact detectors', 'm', 'low', f(6)),
  m('goal_distance_m', 'goal distance', 'm', '', f(2)),
  m('objects', 'objects', '', '', f(0)),
  m('witness_clearance_m', 'clearance of the witness', 'm', ''),
  m('blocked_fraction', 'blocked part of the straight line', '', '', f(2)),
  m('narrowest_gap_m', 'narrowest gap between objects', 'm', ''),
  m('t_step_median_us', 'control step, median', '\u00b5s', 'low', f(1)),
  m('t_step_p99_us', 'control step, 99th percentile', '\u00b5s', 'low', f(1)),
  m('t_step_max_us', 'control step, longest', '\u00b5s', 'low', f(1)),
  m('t_solve_median_us', 'QP solution, median', '\u00b5s', 'low', f(1)),
  m('t_solve_p99_us', 'QP solution, 99th percentile', '\u00b5s', 'low', f(1)),
  m('t_solve_max_us', 'QP solution, longest', '\u00b5s', 'low', f(1)),
  m('t_trial_us', 'whole trial, wall time', '\u00b5s', 'low', f(0)),
  m('deadline_misses', 'deadline misses', '', 'low', f(0)),
];

const byKey = new Map(kMetrics.map((metric) => [metric.key, metric]));

export function metric(key: string): Metric {
  return byKey.get(key) ?? m(key, key, '', '');
}

/** "time to goal [s]", for axes and table heads. */
export function axisName(of: Metric): string {
  return of.unit === '' ? of.name : `${of.name} [${of.unit}]`;
}

export function withUnit(of: Metric, value: number): string {
  return of.unit === '' || !Number.isFinite(value) ? of.write(value) : `${of.write(value)}\u00a0${of.unit}`;
}
