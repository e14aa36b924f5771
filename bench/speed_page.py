#!/usr/bin/env python3
"""Writes docs/studies/speed.md and its figure from results/speed.json (bench/speed.py): no figure on that page is typed."""
import argparse
import json
import math
import pathlib
import statistics

ROOT = pathlib.Path(__file__).resolve().parent.parent
NAMES = {
    "moma": "moma, `holistic`", "moma, preset moma": "moma, `moma`", "toolbox": "Robotics Toolbox", "mink_steps": "mink",
    "pink_steps": "pink", "proxqp_steps": "Pinocchio + coal + ProxQP", "optuna_asks": "Optuna's TPE",
    "mujoco_mink_trials": "MuJoCo + mink", "mujoco_mink_trials, defaults": "MuJoCo as it comes + mink",
}
SCENES = {"frankie-0": "no objects", "frankie-10": "10 objects", "frankie-40": "40 objects", "panda-2": "NEO's scene"}
COLOURS = ["#2563eb", "#60a5fa", "#dc2626", "#16a34a", "#d97706", "#7c3aed"]


def number(value):
    """Three digits."""
    if value == 0:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:.{digits}f}"


def spread(values, how=number):
    return f"{how(statistics.median(values))} ({how(min(values))} to {how(max(values))})"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "| --- " + "| ---: " * (len(head) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


class Rounds:
    """Of one group and scene: what every one took in every round."""

    def __init__(self, kept, group, scene):
        self.found = {name.split("/")[2]: values for name, values in kept["rounds"].items()
                      if name.split("/")[:2] == [group, scene]}

    def __contains__(self, who):
        return who in self.found

    def values(self, who, key):
        return [key(value) for value in self.found[who]]

    def ratios(self, who, key, base="moma"):
        """Round by round, of those that both have."""
        if all("moma_us" in value for value in self.found[who]):
            return [value["us"] / value["moma_us"] for value in self.found[who]]
        mine = {value["round"]: key(value) for value in self.found[base]}
        return [key(value) / mine[value["round"]] for value in self.found[who] if value["round"] in mine]


def us(value):
    return value["us"]


def per_step(value):
    return 1e6 * value["cpu_s"] / value["control_steps"]


def rate(value):
    return value["trials"] / value["cpu_s"]


def steps_section(kept):
    out, whos = [], [who for who in NAMES if any(f"steps/{scene}/{who}" in kept["rounds"] for scene in SCENES)]
    for head, what in (("us a step", lambda r, who: spread(r.values(who, us))),
                       ("times moma's `holistic`", lambda r, who: spread(r.ratios(who, us)) if who != "moma" else "1")):
        rows = []
        for who in whos:
            rounds = {scene: Rounds(kept, "steps", scene) for scene in SCENES}
            rows.append([NAMES[who]] + [what(r, who) if who in r else "" for r in rounds.values()])
        out.append(table([head] + list(SCENES.values()), rows))
    return "\n\n".join(out)


def tail_rows(kept):
    rows = []
    for label, found in kept["tail"].items():
        for clock, prefix in (("processor time", "cpu_"), ("steady clock", "")):
            rows.append([f"moma, {label} ({found['load']:.1f} cores busy with others), {clock}", f"{found['steps']:,}"] +
                        [number(found[prefix + key]) for key in ("p50", "p999", "worst")])
    for who in ("toolbox", "mink_steps", "pink_steps", "proxqp_steps"):
        found = Rounds(kept, "steps", "frankie-10")
        if who in found:
            steps = sum(found.values(who, lambda v: v["steps"]))
            rows.append([NAMES[who] + ", processor time", f"{steps:,}"] + [
                number(statistics.median(found.values(who, lambda v, k=key: v[k]))) for key in ("cpu_p50", "cpu_p999")] +
                [number(max(found.values(who, lambda v: v["cpu_worst"])))])
    return rows


def control_alone(value):
    """Without contacts and measures, where a loop has them apart."""
    return 1e6 * (value["cpu_s"] - value.get("look_s", 0.0)) / value["control_steps"]


def trials_section(kept, group):
    rows, head = [], ["worlds", "", "trials a second of one core", "us a control step, all in", "times moma's"]
    looks = any("look_s" in value for name, values in kept["rounds"].items() if name.startswith(group) for value in values)
    head += ["times moma's if they only controlled"] * looks + ["goals", "contacts"]
    for scene in ("frankie-0", "frankie-10"):
        rounds = Rounds(kept, group, scene)
        for who in NAMES:
            if who not in rounds:
                continue
            last = rounds.found[who][0]
            row = [SCENES[scene], NAMES[who], spread(rounds.values(who, rate)), spread(rounds.values(who, per_step)),
                   "1" if who == "moma" else spread(rounds.ratios(who, per_step))]
            if looks:
                row.append("" if who == "moma" else spread(rounds.ratios(who, control_alone)))
            rows.append(row + [f"{last['successes']} of {last['trials']}", str(last["collisions"])])
    return table(head, rows)


def shares(kept):
    """Of the MuJoCo loop's processor time."""
    words = []
    for scene in ("frankie-0", "frankie-10"):
        rounds = Rounds(kept, "dynamic", scene)
        if "mujoco_mink_trials" in rounds:
            part = {key: 100 * statistics.median(rounds.values("mujoco_mink_trials", lambda v, k=key: v[k] / v["cpu_s"]))
                    for key in ("mj_step_s", "mink_s")}
            words.append(f"{SCENES[scene]}: {part['mj_step_s']:.0f} % in `mj_step`, {part['mink_s']:.0f} % in mink")
    return "; ".join(words)


def engine_ratio(kept):
    """MuJoCo's step alone against all of moma's trial, per control step."""
    words = []
    for scene in ("frankie-0", "frankie-10"):
        rounds = Rounds(kept, "dynamic", scene)
        if "mujoco_mink_trials" in rounds and "moma" in rounds:
            alone = statistics.median(rounds.values("mujoco_mink_trials", lambda v: 1e6 * v["mj_step_s"] / v["control_steps"]))
            all_in = statistics.median(rounds.values("moma", per_step))
            words.append(f"{SCENES[scene]}: {number(alone)} against {number(all_in)} us a control step")
    return "; ".join(words)


def memory_rows(kept):
    rows = []
    places = [("moma", "kinematic"), ("toolbox", "kinematic"), ("mink_steps", "kinematic"), ("pink_steps", "kinematic"),
              ("proxqp_steps", "kinematic"), ("mujoco_mink_trials", "dynamic")]
    for who, group in places:
        trials, steps = Rounds(kept, group, "frankie-10"), Rounds(kept, "steps", "frankie-10")
        if who not in trials:
            continue
        startup = spread(steps.values(who, lambda v: 1e3 * v["startup_s"])) if who in steps else ""
        rows.append([NAMES[who], number(statistics.median(trials.values(who, lambda v: v["rss_mib"]))), startup])
    return rows


def scaling_rows(kept):
    return [[f"{row['trials']:,}", number(1e3 * row["cpu_s"] / row["trials"]), number(row["rss_mib"]),
             number(1024 * row["store_mib"] / row["trials"])] for row in kept["scaling"]]


def growth_sentence(kept):
    """Bytes by which memory grows."""
    if len(kept["scaling"]) < 2:
        return ""
    before, last = kept["scaling"][-2:]
    each = 2**20 * (last["rss_mib"] - before["rss_mib"]) / (last["trials"] - before["trials"])
    return f"From the last but one row to the last the process grew by {each:.0f} bytes a trial: the list of what is to be done, with keys."


def figure(kept):
    """Step time by objects, logarithmic: one line for each."""
    scenes = {"frankie-0": 0, "frankie-10": 10, "frankie-40": 40}
    lines = {}
    for who in NAMES:
        for scene, objects in scenes.items():
            rounds = Rounds(kept, "steps", scene)
            if who in rounds:
                lines.setdefault(who, []).append((objects, statistics.median(rounds.values(who, us))))
    width, height, left, top, right, bottom = 720, 360, 70, 20, 230, 45
    every = [value for line in lines.values() for _, value in line]
    low, high = math.floor(math.log10(min(every))), math.ceil(math.log10(max(every)))

    def x(objects):
        return left + (width - left - right) * objects / 40

    def y(value):
        return top + (height - top - bottom) * (high - math.log10(value)) / (high - low)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12" '
           'role="img" aria-label="Time of a control step by the number of objects">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for power in range(low, high + 1):
        out.append(f'<line x1="{left}" x2="{width - right}" y1="{y(10**power):.1f}" y2="{y(10**power):.1f}" stroke="#ddd"/>'
                   f'<text x="{left - 8}" y="{y(10**power) + 4:.1f}" text-anchor="end">{10**power:g}</text>')
    for objects in scenes.values():
        out.append(f'<text x="{x(objects):.1f}" y="{height - bottom + 18}" text-anchor="middle">{objects}</text>')
    out.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 8}" text-anchor="middle">objects</text>'
               f'<text x="16" y="{(top + height - bottom) / 2:.0f}" text-anchor="middle" '
               f'transform="rotate(-90 16 {(top + height - bottom) / 2:.0f})">us of processor time a control step</text>')
    labels = []
    for colour, (who, line) in zip(COLOURS, lines.items()):
        points = " ".join(f"{x(o):.1f},{y(v):.1f}" for o, v in line)
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x(o):.1f}" cy="{y(v):.1f}" r="3.5" fill="{colour}"/>' for o, v in line]
        labels.append([y(line[-1][1]), NAMES[who].replace("`", ""), colour])
    labels.sort()
    for i in range(1, len(labels)):
        labels[i][0] = max(labels[i][0], labels[i - 1][0] + 15)
    out += [f'<text x="{width - right + 10}" y="{at + 4:.1f}" fill="{colour}">{name}</text>' for at, name, colour in labels]
    return "\n".join(out + ["</svg>"]) + "\n"


def cores_sentence(kept):
    found = kept["cores"]
    if not found or not found["rounds"]:
        return "Two cores against one were not measured."
    rounds, trials = found["rounds"], found["trials"]
    if found["quiet"]:
        ratios = [r["wall"][0] / r["wall"][1] for r in rounds]
        return f"{trials} dynamic trials on two threads took {spread(ratios)} times less wall time than on one."
    dearer = [r["cpu"][1] / r["cpu"][0] for r in rounds]
    alone = [1e3 * r["alone"] for r in rounds]
    waits = [100 * (2 * r["share"] - 1) for r in rounds]
    ratios = [r["cpu"][0] / (r["alone"] + r["share"] * (max(r["cpu"]) - r["alone"])) for r in rounds]
    return (f"Others kept {found['load']:.1f} cores busy, so that wall time tells nothing. What keeps two threads from taking "
            f"half the time, of {trials} dynamic trials: side by side they cost {spread(dearer)} times the processor time (less "
            f"than 1 is the noise of a busy machine and counts as 1); {spread(alone)} ms of it are one thread's alone (start, "
            f"reading, the end of the store); at the end one waits for the other, {spread(waits, lambda v: f'{v:.1f}')} % of a thread's "
            f"work, by control steps. Together: two cores are {spread(ratios)} times as quick as one. Where nothing else runs "
            f"the script measures wall time instead.")


def page(kept):
    machine = kept["machine"]
    versions = sorted({value["version"] for values in kept["rounds"].values() for value in values if "version" in value})
    left_out = [f"- {name}: {why}" for name, why in kept["left_out"].items()]
    rounds = max(len(values) for values in kept["rounds"].values())
    asks = Rounds(kept, "search", "")
    text = (ROOT / "bench/speed_page.md.in").read_text(encoding="utf-8")
    parts = {
        "machine": f"{machine['cpu']}, {machine['cores']} cores, {machine['date']}; cores that others kept busy when the parts began: "
                   + ", ".join(f"{load:.1f} ({part})" for part, load in sorted(kept["loads"].items())),
        "moma": kept["moma"].split(" (")[0], "versions": "; ".join(versions), "rounds": str(rounds),
        "steps": steps_section(kept),
        "tail": table(["us", "steps", "median", "99.9 %", "longest"], tail_rows(kept)),
        "kinematic": trials_section(kept, "kinematic"), "dynamic": trials_section(kept, "dynamic"),
        "shares": shares(kept), "engine": engine_ratio(kept),
        "memory": table(["", "greatest memory MiB", "processor time to the first step ms"], memory_rows(kept)),
        "scaling": table(["trials", "ms of processor time a trial", "greatest memory MiB", "KiB of the store a trial"],
                         scaling_rows(kept)),
        "growth": growth_sentence(kept), "cores": cores_sentence(kept),
        "optuna": spread(asks.values("optuna_asks", lambda v: v["us"] / 1e3)) if "optuna_asks" in asks else "(left out)",
        "left_out": "Left out in this run:\n\n" + "\n".join(left_out) if left_out else "Nothing was left out in this run.",
    }
    for name, value in parts.items():
        text = text.replace(f"@{name}@", value)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=pathlib.Path, default=ROOT / "results/speed.json")
    options = parser.parse_args()
    kept = json.loads(options.json.read_text(encoding="utf-8"))
    (ROOT / "docs/studies/speed.md").write_text(page(kept), encoding="utf-8")
    (ROOT / "docs/images/speed.svg").write_text(figure(kept), encoding="utf-8")


if __name__ == "__main__":
    main()
