"""Whole trials in MuJoCo with mink as the controller: the same worlds, robot, pairs of solids and rules of the end as moma's.

    mujoco_mink_trials.py SCENE.json --trials N [--defaults]

Drives are those of moma's cross-checks with MuJoCo (tests/tools/mujoco_plant.py): constraints that hold their rates as
exactly as ODE's motors do; physics at MuJoCo's 2 ms. --defaults leaves MuJoCo's solver as it comes: quicker, and wheels
creep. Contact ends a trial; it is looked for once a control period. Prints one line of JSON, with the parts of the
processor time that mj_step and mink took.
"""
import argparse
import json
import resource
import time

import numpy as np

from mink_steps import make, mjcf, mujoco
from common import PERIOD, SUCCESS
from mujoco_plant import STEP, MujocoPlant, arm_of, ramp


def placed(plant, model, start):
    """The robot where the world has it."""
    free = model.jnt_qposadr[model.joint("@free").id]
    x, y, phi = start["base"]
    plant.data.qpos[free: free + 2] = x, y
    plant.data.qpos[free + 3: free + 7] = np.cos(phi / 2), 0, 0, np.sin(phi / 2)
    plant.data.qpos[plant.arm.position(model)] = start["q"]
    plant.aim[plant.dof:] = start["q"]
    mujoco.mj_forward(model, plant.data)


def trial(scene, world, defaults, spent):
    objects = [{**item, "kind": item["shape"]} for item in world["objects"]]
    begin = time.process_time()
    step = make({**scene, **world})
    model = mujoco.MjModel.from_xml_string(mjcf(scene["model"], objects=objects, own_contacts=True, defaults=defaults))
    plant = MujocoPlant(model, scene["model"], arm_of(scene["model"]))
    placed(plant, model, world["start"])
    spent["set_up_s"] += time.process_time() - begin
    robot = np.zeros(model.ngeom, bool)
    robot[plant.shapes] = True
    own = ~np.array([model.geom(i).name.startswith("@") and not robot[i] for i in range(model.ngeom)])
    base, inside = np.array(world["start"]["base"]), 0
    limits = scene["model"]["base"]["max_acceleration"]
    for k in range(round(30.0 / PERIOD)):
        begin = time.process_time()
        base, q = plant.base(base[2]), plant.q()
        velocity, position, orientation = step(base, q)
        spent["mink_s"] += time.process_time() - begin
        inside = inside + 1 if position < SUCCESS["position"] and orientation < SUCCESS["orientation"] else 0
        if inside > SUCCESS["steps"]:
            return "success", k
        for _ in range(round(PERIOD / STEP)):
            plant.ramped, plant.mean = ramp(plant.ramped, velocity[: plant.dof], limits, STEP)
            rates = plant.rates(velocity)
            model.eq_data[plant.drives, 0] = plant.aim + plant.LAG * rates
            plant.aim += STEP * rates
            begin = time.process_time()
            mujoco.mj_step(model, plant.data)
            spent["mj_step_s"] += time.process_time() - begin
        pairs = plant.data.contact.geom
        hit = own[pairs].all(axis=1) & robot[pairs].any(axis=1) & (plant.data.contact.dist < 0)
        if hit.any():
            return "collision", k + 1
    return "timeout", k + 1


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--defaults", action="store_true")
    options = parser.parse_args()
    with open(options.scene, encoding="utf-8") as file:
        scene = json.load(file)
    spent = {"set_up_s": 0.0, "mink_s": 0.0, "mj_step_s": 0.0}
    begin = time.process_time()
    ends = [trial(scene, world, options.defaults, spent) for world in scene["worlds"][: options.trials]]
    outcomes = [outcome for outcome, _ in ends]
    print(json.dumps({"trials": len(ends), "successes": outcomes.count("success"), "collisions": outcomes.count("collision"),
                      "control_steps": sum(steps for _, steps in ends), "cpu_s": time.process_time() - begin, **spent,
                      "rss_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                      "version": f"MuJoCo {mujoco.__version__}"}))


if __name__ == "__main__":
    main()
