"""Scenes for bench/peers: the same robot, worlds and states for moma and all others, as moma makes them."""
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUITE = ROOT / "bench/peers/scenes.yaml"
TIP = "panda_hand_tcp"
SCENES = {  # robot, controller, objects
    "frankie-0": ("frankie", "holistic", 0),
    "frankie-10": ("frankie", "holistic", 10),
    "frankie-40": ("frankie", "holistic", 40),
    "panda-2": ("panda", "neo", 2),
}


def settings(name, mode="kinematic", controller=None):
    """What makes the suite this scene's, as words for moma."""
    robot, usual, objects = SCENES[name]
    solids = "[sphere]" if robot == "panda" else "[sphere, box]"
    family = f"{{clutter: {{objects: {objects}, shapes: {solids}}}}}" if objects else "{open: {}}"
    controller = controller or usual
    values = {"robot": ROOT / f"configs/robots/{robot}.yaml", "worlds.families": family, "simulation.mode": mode,
              "controllers": f"{{{controller}: {ROOT}/configs/controllers/{controller}.yaml}}"}
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def output(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


def model(probe, robot):
    request = json.dumps({"ask": "model", "robot": str(ROOT / f"configs/robots/{robot}.yaml")})
    done = subprocess.run([str(probe)], input=request + "\n", capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def make(name, moma, probe, folder, worlds):
    """Writes the scene's file and returns its path."""
    robot = SCENES[name][0]
    store = folder / f"{name}.db"
    store.unlink(missing_ok=True)
    output(moma, "run", SUITE, "-o", store, "-q", "--threads", 1, *settings(name))
    trial = json.loads(output(moma, "query", store, "SELECT trial FROM v_trials", "-f", "json"))[0]["trial"]
    motion = json.loads(output(moma, "replay", store, trial, "--json"))
    scene = {"name": name, "tip": TIP, "urdf": str(ROOT / "configs/robots/panda.urdf"), "model": model(probe, robot)}
    base = motion["robot"]["base"]
    scene["model"]["base"]["max_speed"] = [base.get("max_linear", 0.0), base.get("max_angular", 0.0)]
    scene["goal"], scene["objects"] = motion["world"]["goal"], motion["world"]["objects"]
    scene["states"] = [{"base": s["base"], "q": s["q"]} for s in motion["samples"]]
    scene["worlds"] = []
    for index in range(worlds):
        world = json.loads(output(moma, "world", SUITE, index, "--json", *settings(name)))
        scene["worlds"].append({key: world[key] for key in ("start", "goal", "objects")})
    file = folder / f"{name}.json"
    file.write_text(json.dumps(scene), encoding="utf-8")
    return file
