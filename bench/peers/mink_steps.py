"""mink: a frame task on E, limits of joints and speeds, and its rows for objects and for the robot itself. The base, a
differential drive, turns and then drives along its heading; where it is goes into its body's place."""
import os
import sys
import xml.etree.ElementTree as ET
from importlib.metadata import version

os.environ["MUJOCO_GL"] = "disable"
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import mink  # noqa: E402
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
from mjcf import mjcf  # noqa: E402

from common import PERIOD, angle, pose, run  # noqa: E402

RATE = 1.5               # of the error [1/s]
INFLUENCE, STOP = 0.3, 0.05


def kinematic_model(scene):
    """The bolted robot of moma's cross-checks; on wheels with a hinge and a slide under its base."""
    root = ET.fromstring(mjcf(scene["model"], held=True, driven=False, objects=[
        {**item, "kind": item["shape"]} for item in scene["objects"]]))
    if scene["model"]["base"]["type"] != "fixed":
        base = root.find("worldbody/body[@name='@base']")
        base.insert(0, ET.Element("joint", name="@drive", type="slide", axis="1 0 0"))
        base.insert(0, ET.Element("joint", name="@turn", type="hinge", axis="0 0 1"))
    return mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))


def make(scene):
    file = scene["model"]
    model = kinematic_model(scene)
    mobile = file["base"]["type"] != "fixed"
    configuration = mink.Configuration(model)
    tip = next(model.body(i).name for i in range(model.nbody) if model.body(i).name.split("/")[0] == scene["tip"])
    task = mink.FrameTask(tip, "body", position_cost=1.0, orientation_cost=1.0, gain=RATE * PERIOD, lm_damping=1e-3)
    task.set_target(mink.SE3.from_matrix(pose(scene["goal"])))
    speeds = {link["joint"]["name"]: link["joint"]["velocity"] for link in file["links"] if "joint" in link}
    if mobile:
        speeds["@drive"], speeds["@turn"] = file["base"]["max_speed"]
    limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, speeds)]
    names = [item["name"] for item in file["shapes"]]
    things = [f"object{i}" for i in range(len(scene["objects"]))]
    far = {"minimum_distance_from_collisions": STOP, "collision_detection_distance": INFLUENCE}
    own = {"minimum_distance_from_collisions": 0.01, "collision_detection_distance": 0.1}
    if things:
        limits.append(mink.CollisionAvoidanceLimit(model, [(names, things)], gain=PERIOD / (INFLUENCE - STOP), **far))
    pairs = [([names[a]], [names[b]]) for a, b in file["self_pairs"]]
    limits.append(mink.CollisionAvoidanceLimit(model, pairs, gain=PERIOD / 0.09, **own))
    body = model.body(next(model.body(i).name for i in range(model.nbody) if model.body(i).name.startswith("@base"))).id
    at = [int(model.jnt_qposadr[model.joint(name).id]) for name in file["joints"]]
    dof = [int(model.jnt_dofadr[model.joint(name).id]) for name in file["joints"]]
    if mobile:
        turn, drive = model.joint("@turn").id, model.joint("@drive").id
        dof = [int(model.jnt_dofadr[drive]), int(model.jnt_dofadr[turn])] + dof
    values = np.zeros(model.nq)

    def step(base, q):
        values[at] = q
        if mobile:
            model.body_pos[body][:2] = base[:2]
            values[model.jnt_qposadr[turn]] = base[2]
        configuration.update(values)
        error = task.compute_error(configuration)
        X = configuration.get_transform_frame_to_world(tip, "body").as_matrix()
        try:
            velocity = mink.solve_ik(configuration, [task], PERIOD, "daqp", damping=1e-3, limits=limits)[dof]
        except mink.exceptions.NoSolutionFound:
            velocity = np.zeros(len(dof))
        return velocity, np.linalg.norm(error[:3]), angle(X[:3, :3].T @ pose(scene["goal"])[:3, :3])

    robot = [model.geom(name).id for name in names]
    solids = [model.geom(name).id for name in things]
    pairs_of_objects = [(a, b) for a in robot for b in solids]
    own_pairs = [(robot[a], robot[b]) for a, b in file["self_pairs"]]
    least = {}

    def nearest(kind, pairs):
        """Of these pairs in this state; nothing that is farther than what was the least so far is worth its exact value."""
        d = min((mujoco.mj_geomDistance(model, configuration.data, a, b, least.get(kind, 10.0), None) for a, b in pairs),
                default=np.inf)
        least[kind] = max(min(least.get(kind, 10.0), d), 1e-3)
        return d

    def look():
        J = configuration.get_frame_jacobian(tip, "body")[:3, dof[-len(at):]]
        return nearest("objects", pairs_of_objects), nearest("own", own_pairs), np.sqrt(max(np.linalg.det(J @ J.T), 0.0))

    step.look = look
    return step


if __name__ == "__main__":
    run(make, f"mink {version('mink')}, MuJoCo {mujoco.__version__}, DAQP {version('daqp')}")
