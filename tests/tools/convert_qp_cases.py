#!/usr/bin/env python3
"""Converts the independent oracle's control steps into case files of `moma solve`.

    tests/tools/convert_qp_cases.py QP_CASES.jsonl QP_CASES_ROBOTS.json [-o tests/data/qp_cases]

Reads one control step per line, and the robots' constants, in the oracle's own field names (its conventions note is
copied into the output's README). Writes robots/*.yaml, cases/*.json (what `moma solve` reads) and expectations.jsonl
(the oracle's numbers in moma's names). Needs nothing but Python. Run again, it writes the same bytes.
"""

import argparse
import json
import math
import pathlib

PACKAGE_PREFIX = "cmeel.prefix/share/"
READY = {
    "panda": [0, -0.3, 0, -2.2, 0, 2.0, 0.785],
    "frankie": [0, -0.3, 0, -2.2, 0, 2.0, 0.785],
    "ur5": [0, -1.57, 1.57, -1.57, -1.57, 0],
}


def quaternion(pose):
    """Unit quaternion [w, x, y, z], w >= 0, of a 4 x 4 pose; the largest component is found first (Shepperd 1978)."""
    r = [row[:3] for row in pose[:3]]
    trace = r[0][0] + r[1][1] + r[2][2]
    pick = max(range(4), key=lambda i: trace if i == 0 else r[i - 1][i - 1])
    if pick == 0:
        q = [1 + trace, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]
    else:
        i, j, k = [(0, 1, 2), (1, 2, 0), (2, 0, 1)][pick - 1]
        q = [0.0] * 4
        q[0] = r[k][j] - r[j][k]
        q[1 + i] = 1 + r[i][i] - r[j][j] - r[k][k]
        q[1 + j] = r[j][i] + r[i][j]
        q[1 + k] = r[k][i] + r[i][k]
    norm = math.copysign(math.sqrt(sum(c * c for c in q)), q[0])
    return [c / norm for c in q]


def position(pose):
    return [pose[i][3] for i in range(3)]


def shape_names(capsules):
    """moma's names of a robot's shapes: the link's, with /2, /3 ... from its second shape on."""
    count, names = {}, []
    for capsule in capsules:
        link = capsule["link"]
        count[link] = count.get(link, 0) + 1
        names.append(link if count[link] == 1 else f"{link}/{count[link]}")
    return names


def robot_yaml(robot):
    assert robot["urdf"].startswith(PACKAGE_PREFIX)
    lines = [
        f"# The oracle's {robot['name']}: see README.md. URDF from {robot['package']},",
        f"# sha256 {robot['urdf_sha256']}.",
        f"urdf: package://{robot['urdf'][len(PACKAGE_PREFIX):]}",
        "base:",
    ]
    if robot["base"] == "fixed":
        lines.append("  type: fixed")
    else:
        lines += ["  type: differential", f"  max_linear: {robot['v_max'][0]}", f"  max_angular: {robot['v_max'][1]}"]
    lines.append(f"  mount: {{position: {robot['mount_xyz']}, rpy: {robot['mount_rpy']}}}")
    lines += ["arm:", f"  tip: {robot['ee_frame']}", "  limits:"]
    for name, velocity, low, high in zip(robot["joints"], robot["qd_max"], robot["q_lower"], robot["q_upper"]):
        lines.append(f"    {name}: {{lower: {low}, upper: {high}, velocity: {velocity}}}")
    lines += [f"  ready: {READY[robot['name']]}", "collision:", "  shapes:"]
    for c in robot["capsules"]:
        link = f"'{c['link']}'" if c["link"].startswith("@") else c["link"]
        lines.append(f"    - {{link: {link}, shape: capsule, size: [{c['radius']}, {c['length']}], "
                     f"position: {c['xyz']}, rpy: {c['rpy']}}}")
    pairs = ", ".join("[" + ", ".join(f"'{n}'" if n.startswith("@") else n for n in pair) + "]"
                      for pair in robot["self_pairs"])
    lines.append(f"  self: [{pairs}]")
    return "\n".join(lines) + "\n"


def controller(params):
    damper = {"influence": params["d_i"], "stop": params["d_s"], "gain": params["xi"]}
    out = {
        "method": "qp",
        "servo": {"position": params["k_p"], "orientation": params["k_o"]},
        "error_norm": {"kind": "euclidean", "min": 0.001, "max": 10},
        "base_weight": "inverse_error",
        "lambda_q": params["lambda_q"],
        "slack": {"weight": "inverse_error", "limit": params["delta_max"]},
        "tracking_band": params["Delta"],
        "k_epsilon": params["k_eps"],
        "manipulability": {"weight": params["gain_m"],
                           "rows": {"trans": "translation", "all": "all"}[params["manip"]]},
        "joint_limits": {"method": "source", "margin": params["q_s"]},
        # More than any case has, so that no row is cut.
        "collision": {"enabled": True, **damper, "max_pairs": 100, "floor": {"enabled": False},
                      "self": {"enabled": params["self_collision"], **damper}},
        "solver": "daqp",
    }
    if "lambda_qdd" in params:
        out["acceleration"] = {"weight": params["lambda_qdd"]}
        out["posture"] = {"weight": params["lambda_post"], "gain": params["k_post"], "target": params["q_post"]}
    return out


def scene_object(index, obstacle):
    size = {"sphere": lambda: [obstacle["radius"]], "box": lambda: obstacle["size"],
            "cylinder": lambda: [obstacle["radius"], obstacle["length"]]}[obstacle["type"]]()
    return {"name": f"o{index}", "shape": obstacle["type"], "size": size, "position": position(obstacle["pose"]),
            "quaternion": quaternion(obstacle["pose"]), "velocity": [0.0, 0.0, 0.0] + obstacle["velocity"]}


def convert_case(case):
    params = case["params"]
    state = {"base": case["base"], "q": case["q"]}
    if "qd_meas" in params:
        state["qdot"] = params["qd_meas"]
    return {
        "robot": f"../robots/{case['robot']}.yaml",
        "controller": controller(params),
        "state": state,
        "goal": {"position": position(case["T_desired"]), "quaternion": quaternion(case["T_desired"]),
                 "twist": params["twist_ff"]},
        "control_period": 0.02,
        "objects": [scene_object(i, o) for i, o in enumerate(case["obstacles"])],
    }


def convert_pair(pair, names):
    if pair["kind"] == "self":
        first, second = names[pair["shape"]], names[pair["shape2"]]
        normal = [-c for c in pair["n_12"]]   # moma: from the second shape to the first
        if pair["shape"] > pair["shape2"]:
            first, second, normal = second, first, [-c for c in normal]
        out = {"row": f"self/{first}/{second}"}
    else:
        out = {"row": f"object/o{pair['obstacle']}/{names[pair['shape']]}"}
        normal = pair["n_hat"]
    return {**out, "d": pair["d"], "normal": normal, "A": pair["row"], "ubA": pair["ub"]}


def expectation(name, case, names):
    e, params = case["expect"], case["params"]
    whole = params["manip"] == "all"
    out = {
        "name": name, "status": e["status"], "fallback": e["fallback"], "pose": e["T_we"], "J": e["J"],
        "error": e["e_w"] + e["e_v"], "error_norm": e["e_norm"], "nu": e["nu"],
        "manipulability": e["m"] if whole else e["m_t"], "J_m": e["Jm"] if whole else e["Jm_t"],
        "theta_eps": e["theta_eps"], "Q_diagonal": e["H_diag"], "c": e["g"], "lbA": e["lbA"][:6], "ubA": e["ubA"][:6],
        "lb": e["lb"], "ub": e["ub"], "pairs": [convert_pair(p, names) for p in e["pairs"]],
        "left_out": [{"link": p["link"], "object": f"o{p['obstacle']}", "d": p["d"]}
                     for p in e.get("pairs_left_out", [])],
    }
    if e["status"] == "solved":
        out["x"], out["cost"] = e["x"], e["objective"]
    else:
        out["x"] = e["x_fallback"]
    return out


README = """# Control steps computed independently of moma

{count} control steps (Panda, Frankie, UR5): `cases/*.json` are case files of `moma solve`, `robots/*.yaml` their
robots over the URDFs of the PyPI package `example-robot-data` 6.0.0, `expectations.jsonl` the numbers expected.
Everything here is written by `tests/tools/convert_qp_cases.py`; edit nothing by hand.

Origin: an oracle that shares no code with moma: Pinocchio for the kinematics, closed-form and bisection distances
(coal as a second opinion), quadprog, DAQP and ProxQP for the QP, agreeing among themselves. Its own conventions:

```
{conventions}
```

What the conversion does: poses become positions and quaternions (w x y z, w >= 0); obstacle velocities become
`[0; linear]`; `k_o` is the orientation gain; rows for self-collision use the same influence, stop and gain as objects;
floor rows are off, for Frankie's base capsule reaches 1 cm below the floor. `left_out` are pairs in range that no joint
can influence: they have no row. In infeasible cases `x` is the solution with one common slack on the collision rows.

Tolerances: pose, J, nu, manipulability 1e-10; J_m 1e-8 relative; distances 1e-5; x 1e-3 where distances enter, cost
1e-6.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=pathlib.Path, help="the oracle's steps, JSON lines")
    parser.add_argument("robots", type=pathlib.Path, help="the oracle's robots and conventions, JSON")
    default = pathlib.Path(__file__).resolve().parent.parent / "data" / "qp_cases"
    parser.add_argument("-o", "--output", type=pathlib.Path, default=default, help="folder to write (%(default)s)")
    args = parser.parse_args()

    description = json.loads(args.robots.read_text())
    cases = [json.loads(line) for line in args.cases.read_text().splitlines() if line.strip()]
    cases.sort(key=lambda case: case["id"])
    for folder in ("robots", "cases"):
        (args.output / folder).mkdir(parents=True, exist_ok=True)
    names = {}
    for key, robot in description["robots"].items():
        names[key] = shape_names(robot["capsules"])
        (args.output / "robots" / f"{key}.yaml").write_text(robot_yaml(robot))
    with open(args.output / "expectations.jsonl", "w") as expectations:
        for case in cases:
            name = f"{case['robot']}_{case['id']:03d}"
            text = json.dumps(convert_case(case), indent=1)
            (args.output / "cases" / f"{name}.json").write_text(compact(text) + "\n")
            expectations.write(json.dumps(expectation(name, case, names[case["robot"]]), separators=(",", ":")) + "\n")
    readme = README.format(count=len(cases), conventions=description["conventions"].strip())
    (args.output / "README.md").write_text(readme)
    print(f"{len(cases)} cases written to {args.output}")


def compact(text):
    """Puts lists of plain numbers on one line each."""
    out, items = [], None
    for line in text.splitlines():
        stripped = line.strip()
        if items is not None:
            items.append(stripped)
            if stripped.rstrip(",") == "]":
                out[-1] += " ".join(items).replace(" ]", "]")
                items = None
        else:
            out.append(line)
            if stripped.endswith("[") and not stripped.startswith('"objects"'):
                items = []
    return "\n".join(out)


if __name__ == "__main__":
    main()
