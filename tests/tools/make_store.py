#!/usr/bin/env python3
"""Writes a store with made-up but plausible rows, for tests of what reads stores. Standard library only.

usage: make_store.py DEFINITION OUT.db [--kind demo|empty|one|failures|hostile|many|sweep|tuned]
                     [--worlds N] [--controllers N] [--samples N] [--whole N] [--search]

Every number is a pure function of the arguments. The motion of a trial is an interpolation between the start and
the goal's configuration, and its errors follow from forward kinematics of the robot below.
"""
import argparse
import array
import hashlib
import json
import math
import pathlib
import random
import sqlite3
import struct

HOSTILE = ['</script><script>document.title="taken"</script>', 'quo"te\'s & <b>bold</b>', 'naïve – 机器人 🤖']
OUTCOMES = ['collision', 'timeout', 'stuck', 'joint_limit', 'tipped', 'infeasible', 'diverged', 'error']


# ---- a robot: seven joints on a differential base, joint frames as published for Franka's arm ----------------------
H = math.pi / 2
JOINTS = [  # name, parent, child, xyz, rpy, moves, lower, upper
    ('joint1', 'link0', 'link1', (0, 0, 0.333), (0, 0, 0), True, -2.8, 2.8),
    ('joint2', 'link1', 'link2', (0, 0, 0), (-H, 0, 0), True, -1.7, 1.7),
    ('joint3', 'link2', 'link3', (0, -0.316, 0), (H, 0, 0), True, -2.8, 2.8),
    ('joint4', 'link3', 'link4', (0.0825, 0, 0), (H, 0, 0), True, -3.0, -0.1),
    ('joint5', 'link4', 'link5', (-0.0825, 0.384, 0), (-H, 0, 0), True, -2.8, 2.8),
    ('joint6', 'link5', 'link6', (0, 0, 0), (H, 0, 0), True, 0.0, 3.7),
    ('joint7', 'link6', 'link7', (0.088, 0, 0), (H, 0, 0), True, -2.8, 2.8),
    ('tool', 'link7', 'tcp', (0, 0, 0.21), (0, 0, -H / 2), False, 0, 0),
]
MOUNT = (0.15, 0.0, 0.38)
READY = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
SHAPES = [
    {'link': '@base', 'shape': 'box', 'size': [0.8, 0.6, 0.3], 'position': [0, 0, 0.2], 'rpy': [0, 0, 0]},
    {'link': 'link0', 'shape': 'capsule', 'size': [0.07, 0.15], 'position': [0, 0, 0.1], 'rpy': [0, 0, 0]},
    {'link': 'link2', 'shape': 'capsule', 'size': [0.07, 0.2], 'position': [0, -0.16, 0], 'rpy': [H, 0, 0]},
    {'link': 'link4', 'shape': 'capsule', 'size': [0.065, 0.2], 'position': [-0.08, 0.19, 0], 'rpy': [H, 0, 0]},
    {'link': 'link6', 'shape': 'sphere', 'size': [0.08], 'position': [0.03, 0, 0], 'rpy': [0, 0, 0]},
    {'link': 'link7', 'shape': 'cylinder', 'size': [0.05, 0.1], 'position': [0, 0, 0.07], 'rpy': [0, 0, 0]},
    {'link': 'tcp', 'shape': 'box', 'size': [0.06, 0.2, 0.08], 'position': [0, 0, -0.05], 'rpy': [0, 0, 0]},
]


def urdf():
    text = ['<?xml version="1.0"?>', '<robot name="courier">', '  <link name="link0"/>']
    for name, parent, child, xyz, rpy, moves, lower, upper in JOINTS:
        text.append(f'  <link name="{child}"/>')
        text.append(f'  <joint name="{name}" type="{"revolute" if moves else "fixed"}">')
        text.append(f'    <parent link="{parent}"/><child link="{child}"/>')
        text.append('    <origin xyz="{} {} {}" rpy="{} {} {}"/>'.format(*xyz, *rpy))
        if moves:
            text.append(f'    <axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" velocity="2" effort="80"/>')
        text.append('  </joint>')
    return '\n'.join(text + ['</robot>', ''])


def robot(name):
    return {
        'name': name, 'urdf': 'courier.urdf', 'urdf_text': urdf(),
        'base': {'type': 'differential', 'mount': {'position': list(MOUNT), 'rpy': [0, 0, 0]}, 'max_linear': 1.0,
                 'max_angular': 1.5, 'wheels': {'radius': 0.12, 'separation': 0.66}},
        'arm': {'tip': 'tcp', 'tool': {'position': [0, 0, 0], 'rpy': [0, 0, 0]}, 'locked': {}, 'ready': READY},
        'collision': {'shapes': SHAPES},
    }


# ---- forward kinematics -------------------------------------------------------------------------------------------
def product(a, b):
    """Of two poses: the last row of b is 0 0 0 1."""
    (b00, b01, b02, b03), (b10, b11, b12, b13), (b20, b21, b22, b23), _ = b
    return [[x * b00 + y * b10 + z * b20, x * b01 + y * b11 + z * b21, x * b02 + y * b12 + z * b22,
             x * b03 + y * b13 + z * b23 + w] for x, y, z, w in a]


def pose(xyz, rpy):
    (cr, sr), (cp, sp), (cy, sy) = [(math.cos(a), math.sin(a)) for a in rpy]
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, xyz[0]],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, xyz[1]],
            [-sp, cp * sr, cp * cr, xyz[2]], [0, 0, 0, 1]]


FIXED_MOUNT = pose(MOUNT, (0, 0, 0))
FIXED = [(pose(xyz, rpy), moves) for _, _, _, xyz, rpy, moves, _, _ in JOINTS]


def tip(base, q):
    x = product(pose((base[0], base[1], 0), (0, 0, base[2])), FIXED_MOUNT)
    index = 0
    for fixed, moves in FIXED:
        x = product(x, fixed)
        if moves:   # about the joint's own z
            c, s = math.cos(q[index]), math.sin(q[index])
            x = [[a * c + b * s, b * c - a * s, z, w] for a, b, z, w in x]
            index += 1
    return x


def quaternion(x):
    """w, x, y, z with w >= 0."""
    w = math.sqrt(max(0.0, 1 + x[0][0] + x[1][1] + x[2][2])) / 2
    if w > 1e-6:
        return [w, (x[2][1] - x[1][2]) / (4 * w), (x[0][2] - x[2][0]) / (4 * w), (x[1][0] - x[0][1]) / (4 * w)]
    a, b, c = [math.sqrt(max(0.0, (1 + x[i][i]) / 2)) for i in range(3)]
    return [0.0, a, math.copysign(b, x[0][1]), math.copysign(c, x[0][2])]


def rotation_error(goal, now):
    """Rotation vector of goal * now^T."""
    r = [[a * x + b * y + c * z for x, y, z, _ in now[:3]] for a, b, c, _ in goal[:3]]
    angle = math.acos(max(-1.0, min(1.0, (r[0][0] + r[1][1] + r[2][2] - 1) / 2)))
    axis = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]
    size = math.sqrt(sum(v * v for v in axis))
    return [angle * v / size for v in axis] if size > 1e-12 else [0.0, 0.0, 0.0]


# ---- worlds and trials --------------------------------------------------------------------------------------------
def digest(*parts):
    return hashlib.blake2b('|'.join(map(str, parts)).encode(), digest_size=16).digest()


def make_world(index, family, name):
    r = random.Random(f'world {index}')
    start = {'base': [0.0, 0.0, 0.0], 'q': READY}
    bearing, far = r.uniform(-2.2, 2.2), r.uniform(0.6, 3.5)
    goal_base = [far * math.cos(bearing), far * math.sin(bearing), bearing + r.uniform(-0.6, 0.6)]
    goal_q = [q + r.uniform(-0.4, 0.4) for q in READY]
    x = tip(goal_base, goal_q)
    objects = []
    for i in range(0 if family == 'open' else r.randint(5, 15)):
        kind = r.choice(['sphere', 'box', 'capsule', 'cylinder'])
        size = {'sphere': [r.uniform(0.08, 0.25)], 'box': [r.uniform(0.1, 0.5) for _ in range(3)],
                'capsule': [r.uniform(0.05, 0.12), r.uniform(0.3, 1.2)],
                'cylinder': [r.uniform(0.05, 0.2), r.uniform(0.3, 1.5)]}[kind]
        along, aside = r.uniform(0.25, 0.9), r.choice([-1, 1]) * r.uniform(0.5, 1.2)
        obstacle = {'name': f'{kind}{i}', 'shape': kind, 'size': size,
                    'position': [goal_base[0] * along - aside * math.sin(bearing),
                                 goal_base[1] * along + aside * math.cos(bearing), r.uniform(0.2, 1.1)],
                    'quaternion': [1, 0, 0, 0], 'velocity': [0] * 6, 'motion': {'kind': 'static'}}
        if i % 4 == 1:
            obstacle['motion'] = {'kind': 'linear', 'velocity': [0, 0, 0.4, r.uniform(-.1, .1), r.uniform(-.1, .1), 0]}
        objects.append(obstacle)
    distance = math.dist([row[3] for row in tip(start['base'], start['q'])[:3]], [row[3] for row in x[:3]])
    difficulty = {'goal_distance_m': distance, 'objects': len(objects),
                  'witness_clearance_m': r.uniform(0.05, 0.4) if objects else None,
                  'blocked_fraction': r.uniform(0, 0.4) if objects else 0.0,
                  'narrowest_gap_m': r.uniform(0.1, 0.8) if len(objects) > 1 else None}
    world = {'index': index, 'seed': 1, 'family': family, 'robot': name, 'start': start,
             'goal': {'position': [row[3] for row in x[:3]], 'quaternion': quaternion(x), 'twist': [0] * 6,
                      'motion': {'kind': 'static'}},
             'objects': objects, 'witness': {'base': goal_base, 'q': goal_q}, 'difficulty': difficulty}
    return world, x


def make_trace(world, x, end, reach, period):
    """Columns by name. The motion covers `reach` of the way to the witness in `end` seconds."""
    a, b = world['start'], world['witness']
    names = ['t', 'base_x', 'base_y', 'base_phi', *(f'{stem}{i}' for stem, n in (('q', 7), ('qdot', 9), ('command', 9), ('error', 6), ('slack', 6))
                                                    for i in range(n)), 'manipulability', 'least_distance', 'status', 'fallback', 'active_rows']
    rows = []
    steps = max(1, round(end / period))
    for step in range(steps):
        t = step * period
        s = min(1.0, t / end) if end > 0 else 0.0
        s = reach * (3 * s * s - 2 * s * s * s)
        base = [u + s * (v - u) for u, v in zip(a['base'], b['base'])]
        q = [u + s * (v - u) for u, v in zip(a['q'], b['q'])]
        if step % 5 == 0 or step == steps - 1:   # in between the last error stands: forward kinematics is slow here
            now = tip(base, q)
            error = rotation_error(x, now) + [x[i][3] - now[i][3] for i in range(3)]
        waves = [0.1 * math.sin(t + i) for i in range(9)]
        bad = step % 97 == 96
        rows.append((t, *base, *q, *waves, *waves, *error, *[0.002 * math.exp(-t)] * 6, 0.05 + 0.03 * math.sin(q[3] + 2.2),
                     0.05 + abs(1 - s) * 0.4 if world['objects'] else math.inf, float(bad), 3.0 * bad, float(step % 5)))
    return dict(zip(names, zip(*rows)))


def zstd_frame(data):
    """One zstd frame of raw blocks (RFC 8878): valid, not smaller."""
    out = b'\x28\xb5\x2f\xfd' + bytes([0xe0]) + struct.pack('<Q', len(data))
    blocks = [data[i:i + 65536] for i in range(0, len(data), 65536)] or [b'']
    for i, block in enumerate(blocks):
        out += struct.pack('<I', len(block) << 3 | (i == len(blocks) - 1))[:3] + block
    return out


def make_row(r, world, controller, quality, only_failures):
    hard = world['difficulty']['goal_distance_m'] / 4 + world['difficulty']['objects'] / 14
    p = 1 / (1 + math.exp(3.2 * (hard - quality)))
    outcome = 'success'
    if only_failures or r.random() > p:
        outcome = r.choices(OUTCOMES, [3 if world['objects'] else 0, 5, 8, 2, 0.3, 2, 0.2, 0.2])[0]
    goal = world['difficulty']['goal_distance_m']
    arrive = 2.5 + 2.2 * goal * r.uniform(0.8, 1.6) + 0.3 * world['difficulty']['objects'] * r.random()
    arrive = min(29.5, round(arrive / 0.02) * 0.02)
    end = {'success': arrive + 0.2, 'timeout': 30.0}.get(outcome, round(r.uniform(1.5, 18) / 0.02) * 0.02)
    hit = outcome == 'collision'
    row = {
        'outcome': outcome, 'reason': None if outcome in ('success', 'timeout') else {
            'collision': 'contact', 'stuck': 'no coordinate moved for 2 s', 'joint_limit': 'joint4 at its upper limit',
            'tipped': 'base 31 degrees off vertical', 'infeasible': 'no solved QP for 0.5 s',
            'diverged': 'state not finite', 'error': 'std::bad_alloc'}[outcome],
        'link': r.choice(['link4', 'link6', '@base', 'tcp']) if hit else None,
        'object': r.choice([o['name'] for o in world['objects']] + ['floor', 'self:link2']) if hit else None,
        'time_end_s': end, 'time_to_goal_s': arrive if outcome == 'success' else None,
        'position_error_m': r.uniform(0.001, 0.015) if outcome == 'success' else r.uniform(0.05, 1.5),
        'orientation_error_rad': r.uniform(0.002, 0.04) if outcome == 'success' else r.uniform(0.05, 1.2),
        'path_ee_m': goal * r.uniform(1.05, 1.6), 'path_base_m': goal * r.uniform(0.9, 1.8),
        'manip_mean': max(0.003, r.gauss(0.062 + 0.008 * quality, 0.013)), 'manip_min': r.uniform(0.005, 0.05),
        'manip_final': r.uniform(0.02, 0.1), 'manip_all_mean': r.uniform(0.05, 0.1),
        'manip_all_min': r.uniform(0.005, 0.05), 'manip_all_final': r.uniform(0.02, 0.1),
        'clearance_min_m': (-0.004 if hit else r.uniform(0.01, 0.3)) if world['objects'] else None,
        'clearance_self_min_m': r.uniform(0.02, 0.1), 'limit_margin_min': r.uniform(0, 0.3),
        'collision_count': int(hit), 'collision_time_s': end if hit else None,
        'collision_depth_m': r.uniform(0.0005, 0.02) if hit else None,
        'jerk_ee_rms': r.lognormvariate(1, 0.5), 'jerk_joint_rms': r.lognormvariate(2, 0.5),
        'command_change_mean': r.lognormvariate(-3.5 - 0.5 * quality, 0.5), 'energy_j': r.lognormvariate(4, 0.4),
        'slack_mean': r.lognormvariate(-5, 1), 'slack_max': r.lognormvariate(-3, 1),
        'active_rows_mean': r.uniform(0, 4), 'qp_infeasible': r.randint(0, 20) if outcome != 'success' else 0,
        'fallback_no_acceleration': r.randint(0, 3), 'fallback_relaxed': r.randint(0, 3),
        'fallback_brake': r.randint(0, 9) if outcome == 'infeasible' else 0, 'slip_max_m_s': r.uniform(0, 0.1),
        'tracking_error_rms': r.uniform(0, 0.02), 'lcp_messages': 0, 'steps': round(end / 0.02),
        'detector_checks': round(end), 'detector_disagreements': 0, 'detector_deepest_m': None,
    }
    phases = {'standing': 1, 'speeding_up': 3, 'cruise': 9, 'slowing_down': 3, 'last_5_cm': 2, 'turning': 1, 'dwell': 1}
    for phase, part in phases.items():
        row[f'phase_{phase}_s'] = 0.02 * round(end * part / sum(phases.values()) / 0.02)
    median = r.lognormvariate(2.6 + 0.03 * world['difficulty']['objects'], 0.15)
    timing = {'t_solve_median_us': 0.4 * median, 't_solve_p99_us': 0.9 * median, 't_solve_max_us': 4 * median,
              't_step_median_us': median, 't_step_p99_us': 2.2 * median, 't_step_max_us': median * r.lognormvariate(2, 0.5),
              't_trial_us': median * row['steps'] * 6, 'deadline_misses': int(r.random() < 0.01)}
    return row, timing


def insert(db, table, values):
    names = ', '.join(f'"{name}"' for name in values)
    marks = ', '.join('?' * len(values))
    return db.execute(f'INSERT OR IGNORE INTO {table} ({names}) VALUES ({marks})', list(values.values())).lastrowid


def add_search(db):
    """A search for seven gains: noisy merits that fall towards what is found, the less the later the gain."""
    r = random.Random('search')
    gains = [('controller.base_weight', 0.01, 10.0, 'log', 2.0), ('controller.servo.position', 0.5, 6.0, 'log', 1.5),
             ('controller.k_epsilon', 0.0, 1.0, 'linear', 0.25), ('controller.lambda_q', 0.001, 1.0, 'log', 0.01),
             ('controller.collision.influence', 0.1, 0.6, 'linear', 0.3), ('controller.collision.gain', 0.2, 2.0, 'log', 1.0),
             ('controller.slack', 10.0, 1000.0, 'log', 100.0)]
    found = [0.31, 2.4, 0.4, 0.03, 0.35, 0.8, 90.0]
    importance = [0.05, 0.6, 0.2, 0.08, 0.03, 0.01, 0.0]
    search_id = insert(db, 'tune_search', {
        'hash': digest('search'), 'suite': 'courier-clutter', 'controller': 'holistic', 'identity': '{}',
        'objective': 'mean cost over worlds: time to goal, 30 where not reached', 'unit': 's', 'budget_trials': 4000,
        'started': '2025-03-14T10:00:00Z', 'ended': '2025-03-14T10:05:00Z', 'status': 'finished', 'trials': 3890,
        'trials_saved': 1200, 'evaluations_cut': 31, 'held_out_suite': None, 'verdict': 'better', 'runs': '[]',
        'notes': json.dumps(['base_weight was found near its lower bound'])})
    for i, (key, lower, upper, scale, start) in enumerate(gains):
        insert(db, 'tune_variable', {'search_id': search_id, 'variable': i, 'key': key, 'lower': lower, 'upper': upper,
                                     'scale': scale, 'start': start, 'found': found[i], 'importance': importance[i]})
        for k, factor in enumerate((0.25, 0.5, 1.0, 2.0, 4.0)):
            insert(db, 'tune_sensitivity', {'search_id': search_id, 'entry': 10 * i + k, 'variable': i, 'other': None,
                                            'value': found[i] * factor, 'change': 2.0 * math.log(factor) ** 2 * importance[i],
                                            'error': 0.2, 'valid': 1})
    for n in range(90):
        phase = 'start' if n == 0 else 'global' if n < 60 else 'local' if n < 80 else 'confirm'
        spread = 1.5 * math.exp(-n / 30)
        at = [v * math.exp(r.gauss(0, spread)) for v in found]
        merit = 9 + sum(4 * w * math.log(a / b) ** 2 for a, b, w in zip(at, found, importance)) + r.gauss(0, 0.2)
        insert(db, 'tune_evaluation', {
            'search_id': search_id, 'evaluation': n, 'phase': phase, 'run': 0, 'candidate': json.dumps(at), 'first_world': 0,
            'worlds': 40 if merit > 12 else 100, 'cut': int(merit > 12), 'valid': 1, 'cost': merit, 'merit': merit,
            'constraints': '[]', 'measured': b''})
    measured = (('success', 0.49, 0.61, 0.0004), ('collision', 0.06, 0.04, 0.2), ('objective', 19.5, 16.1, None),
                ('time_to_goal_s', 9.2, 6.4, None))
    for k, (family, other, (metric, theirs, ours, p)) in enumerate(
            (f, o, m) for m in measured for f in ('all', 'clutter', 'open') for o in ('holistic', 'moma')):
        half = 0.04 * max(1.0, ours)
        insert(db, 'tune_comparison', {
            'search_id': search_id, 'entry': k, 'family': family, 'other': other, 'metric': metric, 'n': 500,
            'found': ours, 'found_low': ours - half, 'found_high': ours + half, 'theirs': theirs,
            'theirs_low': theirs - half, 'theirs_high': theirs + half, 'difference': ours - theirs,
            'difference_low': ours - theirs - 1.2 * half, 'difference_high': ours - theirs + 1.2 * half, 'p': p,
            'verdict': 'no difference shown' if metric == 'collision' else 'better'})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('definition', type=pathlib.Path, help='folder of tables.sql and views.sql, as moma_define_store writes them')
    parser.add_argument('out')
    parser.add_argument('--kind', default='demo', choices=['demo', 'empty', 'one', 'failures', 'hostile', 'many', 'sweep', 'tuned'])
    parser.add_argument('--worlds', type=int, default=200)
    parser.add_argument('--controllers', type=int, default=40, help='of the kind many')
    parser.add_argument('--samples', type=int, default=12, help='failures of each point whose samples are kept')
    parser.add_argument('--whole', type=int, default=0, help='worlds of which the samples of all trials are kept')
    parser.add_argument('--search', action='store_true', help='with a search for gains, as of the kind tuned')
    args = parser.parse_args()

    db = sqlite3.connect(args.out)
    # Nobody needs it after a loss of power: the disk is not waited for.
    db.executescript('PRAGMA synchronous = OFF; PRAGMA journal_mode = WAL; PRAGMA application_id = 1836019041; PRAGMA user_version = 4;')
    for name in ('tables.sql', 'views.sql'):
        db.executescript((args.definition / name).read_text(encoding='utf-8'))
    if args.kind == 'empty':
        return
    hostile = args.kind == 'hostile'
    suite = HOSTILE[0] if hostile else 'courier-clutter'
    robot_name = HOSTILE[2] if hostile else 'courier'
    points = [('holistic', '', {}, 0.9), ('moma', '', {}, 1.35)]
    if hostile:
        points[1] = (HOSTILE[1], '', {}, 1.35)
    if args.kind == 'sweep':
        points = [('moma', f'lambda_q={a} k_epsilon={b}', {'controller.lambda_q': a, 'controller.k_epsilon': b},
                   1.3 - 0.6 * abs(math.log10(a) + 2) - 0.3 * abs(b - 0.5)) for a in (0.001, 0.01, 0.1)
                  for b in (0.25, 0.5, 1)]
    if args.kind == 'many':
        points = [(f'controller{i:02d}', '', {}, 0.4 + 0.03 * ((7 * i) % 40)) for i in range(args.controllers)]
    worlds = 1 if args.kind == 'one' else args.worlds
    families = {'seed': 1, 'families': {'open': {'weight': 1}, 'clutter': {'weight': 1}}}

    robot_id = insert(db, 'robot', {'hash': digest('robot'), 'name': robot_name, 'resolved': json.dumps(robot(robot_name))})
    resolved_id = insert(db, 'resolved_suite', {'hash': digest('suite'), 'resolved': json.dumps({'name': suite})})
    if args.kind == 'tuned' or args.search:   # the search's own suite comes first and keeps no trials
        searched = insert(db, 'suite', {'name': 'courier-search', 'file_name': 'courier-search', 'setting_hash': digest('search setting')})
        parameters_id = insert(db, 'controller', {'hash': digest('searched'), 'resolved': '{}'})
        insert(db, 'point', {
            'suite_id': searched, 'controller': 'holistic', 'controller_name': 'holistic', 'label': '', 'params': '{}',
            'content_hash': digest('searched point'), 'robot_id': robot_id, 'controller_id': parameters_id, 'mode': 'dynamic',
            'control_period_s': 0.02, 'physics_step_s': 0.002, 'time_limit_s': 30, 'success_position_m': 0.02,
            'success_orientation_rad': 0.05, 'success_dwell_s': 0.2, 'stuck_time_s': 2, 'stuck_motion': 0.0005,
            'infeasible_time_s': 0.5, 'worlds': json.dumps(families), 'simulation_version': 1,
            'resolved_suite_id': resolved_id, 'resolved_position': 0})
    suite_id = insert(db, 'suite', {'name': suite, 'file_name': suite, 'setting_hash': digest('setting')})
    invocation_id = insert(db, 'invocation', {
        'suite_id': suite_id, 'resolved_suite_id': resolved_id, 'started': '2025-03-14T09:26:53Z',
        'ended': '2025-03-14T09:28:31Z', 'status': 'finished',
        'arguments': json.dumps(['moma', 'run', 'configs/suites/demo.yaml', '-o', 'results/demo.db']),
        'moma_version': '0.1.0', 'git_commit': '0123456789abcdef0123456789abcdef01234567', 'git_dirty': 0,
        'build_type': 'Release', 'compiler': 'GNU 12.2.0', 'compiler_flags': '-O3 -DNDEBUG -ffp-contract=off',
        'libraries': json.dumps({'ODE': '0.16.2', 'Eigen': '3.4.0', 'DAQP': '0.11.0', 'coal': '3.0.3'}),
        'host': HOSTILE[1] if hostile else 'bench-01', 'os': 'Debian GNU/Linux 12', 'cpu': 'A CPU with two cores',
        'cpu_count': 2, 'threads': 2, 'machine_class': 'x86-64 avx2', 'trials_planned': worlds * len(points),
        'trials_present': 0, 'trials_done': worlds * len(points)})
    made = [make_world(i, 'open' if i % 2 == 0 and args.kind != 'one' else 'clutter', robot_name) for i in range(worlds)]
    if hostile:
        for world, _ in made:
            for obstacle in world['objects']:
                obstacle['name'] += HOSTILE[1]
    world_ids = []
    for world, _ in made:
        d = world['difficulty']
        world_ids.append(insert(db, 'world', {
            'hash': digest('world', world['index']), 'world_index': world['index'], 'seed': '1',
            'family': world['family'], 'goal_distance_m': d['goal_distance_m'], 'objects': d['objects'],
            'witness_clearance_m': d['witness_clearance_m'], 'blocked_fraction': d['blocked_fraction'],
            'narrowest_gap_m': d['narrowest_gap_m'], 'json': json.dumps(world)}))
    for position, (controller, label, params, quality) in enumerate(points):
        parameters = {'lambda_q': 0.01, 'k_epsilon': 0.25 if controller == 'holistic' else 0.5, 'beta': 1.0,
                      'collision': {'influence': 0.3, 'stop': 0.02}}
        controller_id = insert(db, 'controller', {'hash': digest(controller, label), 'resolved': json.dumps(parameters)})
        point_id = insert(db, 'point', {
            'suite_id': suite_id, 'controller': controller, 'controller_name': controller, 'label': label,
            'params': json.dumps(params), 'content_hash': digest('point', controller, label), 'robot_id': robot_id,
            'controller_id': controller_id, 'mode': 'dynamic', 'control_period_s': 0.02, 'physics_step_s': 0.002,
            'time_limit_s': 30, 'success_position_m': 0.02, 'success_orientation_rad': 0.05, 'success_dwell_s': 0.2,
            'stuck_time_s': 2, 'stuck_motion': 0.0005, 'infeasible_time_s': 0.5, 'worlds': json.dumps(families),
            'simulation_version': 1, 'resolved_suite_id': resolved_id, 'resolved_position': position})
        kept = 0
        for (world, x), world_id in zip(made, world_ids):
            r = random.Random(f'trial {controller} {label} {world["index"]}')
            row, timing = make_row(r, world, controller, quality, args.kind == 'failures')
            if hostile and row['outcome'] == 'collision':
                row['link'] = HOSTILE[0]
            if hostile and row['reason']:
                row['reason'] = HOSTILE[0]
            key = digest('trial', controller, label, world['index'])
            insert(db, 'trial', {'key': key, 'world_id': world_id, **row})
            insert(db, 'execution', {'key': key, 'invocation_id': invocation_id, **timing})
            insert(db, 'point_trial', {
                'point_id': point_id, 'world_index': world['index'], 'key': key, 'world_id': world_id,
                'family': world['family'],
                **{name: row.get(name) for name in ('outcome', 'time_to_goal_s', 'manip_mean', 'clearance_min_m',
                                                    'command_change_mean')}})
            if (row['outcome'] != 'success' and kept < args.samples) or args.kind == 'one' or world['index'] < args.whole:
                kept += 1
                trace = make_trace(world, x, row['time_end_s'], 1.0 if row['outcome'] == 'success' else 0.8, 0.02)
                data = b''.join(array.array('d', c).tobytes() for c in trace.values())
                insert(db, 'samples', {'key': key, 'layout': 1, 'n': len(trace['t']),
                                       'columns': json.dumps(list(trace)), 'data': zstd_frame(data)})
    if args.kind == 'tuned' or args.search:
        add_search(db)
    db.commit()
    db.execute('PRAGMA wal_checkpoint(TRUNCATE)')
    db.close()


if __name__ == '__main__':
    main()
