"""Steps of moma.VectorEnv beside a loop of MuJoCo and mink on the same task: Frankie among ten spheres and boxes, to goals of the
same worlds, drives and contacts by physics (bench/peers/mujoco_mink_trials.py has that side).

    PYTHONPATH=build/python .venv/bin/python3 bench/env_steps.py [--mode dynamic|kinematic] [--steps 10000] [--envs 50] [--threads 1]
    .venv-peers/bin/python3 bench/peers/mujoco_mink_trials.py SCENE.json --trials 10

Prints one line of JSON: microseconds of processor time (and of the clock) for each step of a trial, with commands that are there
already and with moma's `holistic` asked for each, one by one from Python. --scene FILE writes the other side's scene (needs the
build's physics_probe) and ends.
"""
import argparse
import json
import pathlib
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def suite(mode):
    return {"name": "env-steps", "robot": str(ROOT / "configs/robots/frankie.yaml"),
            "controllers": {"holistic": str(ROOT / "configs/controllers/holistic.yaml")},
            "worlds": {"seed": 7, "families": {"clutter": {"objects": 10, "shapes": ["sphere", "box"]}}},
            "simulation": {"mode": mode, "control_period": 0.02, "time_limit": 30}, "trials": 10}


def measured(env, steps, commands):
    """Of `steps` steps of trials in all: (processor time, time) of each [us], and how many trials ended."""
    env.reset(seed=1)
    ended = 0
    cpu, wall = time.process_time(), time.perf_counter()
    rounds = steps // env.num_envs
    for k in range(rounds):
        _, _, terminated, truncated, _ = env.step(commands(k))
        ended += int((terminated | truncated).sum())
    taken = rounds * env.num_envs
    return 1e6 * (time.process_time() - cpu) / taken, 1e6 * (time.perf_counter() - wall) / taken, ended


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--mode", choices=["dynamic", "kinematic"], default="dynamic")
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--envs", type=int, default=50)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--scene", type=pathlib.Path)
    options = parser.parse_args()
    if options.scene:
        import speed_scenes

        made = speed_scenes.make("frankie-10", ROOT / "build/moma", ROOT / "build/tests/physics_probe", options.scene.parent, 10)
        made.rename(options.scene)
        return
    import moma
    import numpy as np

    env = moma.VectorEnv(suite(options.mode), options.envs, threads=options.threads, objects=10)
    rng = np.random.default_rng(3)
    given = rng.uniform(-0.1, 0.1, (64, options.envs, len(env.robot.velocities)))
    file = ROOT / "configs/controllers/holistic.yaml"
    controllers = [moma.Controller(env.robot, file, env.control_period) for _ in range(options.envs)]

    def asked(k):
        # holistic remembers nothing, so that a trial which has begun anew needs no more than its objects.
        for i in env.begun():
            controllers[i].reset(env.objects(i))
        return np.array([controller.step(env.seen(i)).command for i, controller in enumerate(controllers)])

    result = {"mode": options.mode, "envs": options.envs, "threads": options.threads, "steps": options.steps}
    for name, commands in (("given", lambda k: given[k % 64]), ("holistic", asked)):
        cpu, wall, ended = measured(env, options.steps, commands)
        result[name] = {"cpu_us": round(cpu, 1), "wall_us": round(wall, 1), "trials_ended": ended}
    print(json.dumps(result))


if __name__ == "__main__":
    main()
