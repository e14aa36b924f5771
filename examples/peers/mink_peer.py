"""mink: a frame task on E, limits of joints and speeds, its rows for objects and for the robot itself. The gains are those of
its example arm_ur5e.py, with its limits' own defaults. A differential drive is a hinge and, along the heading, a slide; where
the base is goes into its body's place."""

import os

os.environ["MUJOCO_GL"] = "disable"
import mink
import mujoco
import numpy as np

from parts import frame, mobile, mount, pairs, solids

KINDS = {kind: getattr(mujoco.mjtGeom, "mjGEOM_" + kind.upper()) for kind in ("sphere", "box", "capsule", "cylinder")}


def sizes(kind, size):
    """MuJoCo counts from the middle."""
    return {"sphere": lambda: [size[0], 0, 0], "box": lambda: np.divide(size, 2)}.get(
        kind, lambda: [size[0], size[1] / 2, 0])()


def quaternion(X):
    q = np.zeros(4)
    mujoco.mju_mat2Quat(q, X[:3, :3].flatten())
    return q


def add_geom(body, name, kind, size, X):
    body.add_geom(name=name, type=KINDS[kind], size=sizes(kind, size), pos=X[:3, 3], quat=quaternion(X))


def model_of(robot, objects):
    urdf = robot.description["urdf_text"].replace("</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>')
    arm = mujoco.MjSpec.from_string(urdf)
    for name, value in robot.description["arm"].get("locked", {}).items():
        arm.delete(arm.joint(name))  # held where the URDF has its zero
        assert value == 0.0
    whole = mujoco.MjSpec()
    base = whole.worldbody.add_body(name="@base")
    if mobile(robot):
        base.add_joint(name="@turn", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        base.add_joint(name="@drive", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
        base.mass, base.inertia, base.explicitinertial = 1.0, np.ones(3), True
    X = mount(robot)
    whole.attach(arm, prefix="arm/", frame=base.add_frame(pos=X[:3, 3], quat=quaternion(X)))
    for i, (link, kind, size, X) in enumerate(solids(robot)):
        add_geom(base if link is None else whole.body("arm/" + link), f"robot{i}", kind, size, X)
    for i, item in enumerate(objects):
        add_geom(whole.worldbody.add_body(name=f"object{i}", mocap=True), f"object{i}", item.shape, item.size, np.eye(4))
    return whole.compile()


class Mink:
    def __init__(self, gain=1.0, lm_damping=1.0, damping=1e-3, avoidance=0.85, stop=0.005, influence=0.01):
        self.task = {"gain": gain, "lm_damping": lm_damping}
        self.damping = damping
        self.rows = {"gain": avoidance, "minimum_distance_from_collisions": stop,
                     "collision_detection_distance": max(influence, 1.01 * stop)}

    def reset(self, robot, objects):
        self.robot, self.period = robot, robot.control_period
        model = model_of(robot, objects)
        self.configuration = mink.Configuration(model)
        self.values = np.zeros(model.nq)
        tip = "arm/" + robot.description["arm"]["tip"]
        self.frame_task = mink.FrameTask(tip, "body", position_cost=1.0, orientation_cost=1.0, **self.task)
        joints = ["arm/" + name for name in robot.joints]
        names = (["@drive", "@turn"] if mobile(robot) else []) + joints
        self.dofs = [model.jnt_dofadr[model.joint(name).id] for name in names]
        self.places = [model.jnt_qposadr[model.joint(name).id] for name in joints]
        geoms = [f"robot{i}" for i in range(len(solids(robot)))]
        every = [([geoms[a]], [geoms[b]]) for a, b in pairs(robot)]
        if objects:
            every.append((geoms, [f"object{i}" for i in range(len(objects))]))
        self.limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, dict(zip(names, robot.velocity_limits))),
                       mink.CollisionAvoidanceLimit(model, every, **self.rows)]

    def step(self, seen):
        model, data = self.configuration.model, self.configuration.data
        self.values[self.places] = seen.q
        if mobile(self.robot):
            model.body("@base").pos[:2] = seen.base[:2]
            self.values[model.jnt_qposadr[model.joint("@turn").id]] = seen.base[2]
        for i, item in enumerate(seen.objects):
            data.mocap_pos[i], data.mocap_quat[i] = item.position, quaternion(frame(item))
        self.configuration.update(self.values)
        self.frame_task.set_target(mink.SE3.from_matrix(frame(seen.goal)))
        try:
            velocity = mink.solve_ik(self.configuration, [self.frame_task], self.period, "daqp", self.damping, limits=self.limits)
        except mink.NoSolutionFound:
            return {"command": np.zeros(len(self.dofs)), "status": "infeasible", "fallback": "brake"}
        return velocity[self.dofs]
