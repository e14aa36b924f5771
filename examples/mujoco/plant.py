"""A mobile manipulator in MuJoCo: a robot of moma's with a differential base, on wheels and servos of its own.

The arm is the URDF as MuJoCo reads it. Each of its drives is a PI controller of velocity within the URDF's effort, and carries
its share of the arm's own weight, not of a payload. The base is the robot file's footprint on two driven wheels and four
casters. Both engines share the collision shapes, so that a collision is the same in both; nothing else comes from moma.
"""

import os

os.environ.setdefault("MUJOCO_GL", "disable")  # no picture is drawn
import mujoco
import numpy as np

STEP = 0.002  # [s] of physics
ROBOT, THING, FLOOR = 1, 2, 4  # bits of contype and conaffinity
WHEEL_MASS = 2.0  # [kg] of the footprint's, each
GAINS = {"wheel": (400.0, 40.0), "joint": (4000.0, 200.0)}  # of the integral of the velocity's error, and of the error
STIFF = {"solref": [2 * STEP, 1], "solimp": [0.99, 0.9999, 0.0001, 0.5, 2]}  # wheels neither sink nor creep
GEOM = {name: getattr(mujoco.mjtGeom, f"mjGEOM_{name.upper()}") for name in ("sphere", "box", "capsule", "cylinder", "ellipsoid")}
ACROSS = [[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]  # a cylinder's axis along y


def at(position, rotation=np.eye(3)):
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ravel(rotation).astype(float))
    return {"pos": position, "quat": quaternion}


def solid(shape, **more):
    """A shape as robot files and worlds have it, as MuJoCo takes it."""
    size = shape["size"]
    size = {"sphere": [size[0], 0, 0], "box": np.divide(size, 2)}.get(shape["shape"], [size[0], size[-1] / 2, 0])
    return {"type": GEOM[shape["shape"]], "size": size, **more}


def build(robot, world, payload, floor_friction, eye):
    """The compiled model of a moma.Robot in a moma.World, its camera at `eye` in the base's frame."""
    whole = robot.description
    spec = mujoco.MjSpec()
    spec.compiler.degree = spec.compiler.fusestatic = False
    spec.option.timestep, spec.option.impratio = STEP, 100
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    ground = spec.worldbody
    ground.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=FLOOR, conaffinity=0)
    for item in world.objects:
        ground.add_geom(name=item["name"], pos=item["position"], quat=item["quaternion"],
                        **solid(item, contype=THING, conaffinity=ROBOT))
    body = ground.add_body(name="base")
    body.add_freejoint()
    body.add_geom(name="eye", type=GEOM["sphere"], size=[1e-6, 0, 0], pos=eye, mass=0, contype=0, conaffinity=0, group=1)
    shapes = add_base(body, whole["base"], floor_friction)
    shapes += add_arm(body, robot, payload, len(shapes))
    for first, second, _ in whole["collision"]["pairs"]:
        spec.add_pair(geomname1=shapes[first], geomname2=shapes[second])
    for name in ("left", "right", *robot.joints):
        of_integral, of_error = GAINS["joint" if name in robot.joints else "wheel"]
        for kind in ("integral", "error"):
            drive = spec.add_actuator(name=f"{name} {kind}", target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            drive.set_to_velocity(kv=of_error) if kind == "error" else drive.set_to_intvelocity(kp=of_integral, kv=0)
            drive.actlimited = False
    return spec.compile()


def add_base(body, base, floor_friction):
    """Names of the geoms, in moma's order of shapes: footprint and wheels."""
    footprint, wheels, radius = base["footprint"], base["wheels"], base["wheels"]["radius"]
    touched = {"contype": ROBOT, "conaffinity": THING}
    body.add_geom(name="footprint", **solid(footprint, mass=footprint["mass"] - 2 * WHEEL_MASS, **touched),
                  **at(footprint["position"], footprint["rotation"]))
    for name, side in (("left", 0.5), ("right", -0.5)):
        wheel = body.add_body(name=name, pos=[0, side * wheels["separation"], radius])
        wheel.add_joint(name=name, axis=[0, 1, 0])
        rim = {"shape": "cylinder", "size": [radius, wheels["width"]]}
        wheel.add_geom(name=name, **solid(rim, mass=WHEEL_MASS, **touched), **at([0, 0, 0], ACROSS))
        wheel.add_geom(name=f"tread {name}", type=GEOM["ellipsoid"], size=[radius, wheels["width"] / 2, radius], mass=0,
                       contype=0, conaffinity=FLOOR, friction=[floor_friction, 0, 0], priority=1, **STIFF)
    for x in (0.3, -0.3):
        for y in (0.12, -0.12):  # without friction, and softer than the wheels, which so carry the weight
            body.add_geom(name=f"caster {x} {y}", type=GEOM["sphere"], size=[0.05, 0, 0], pos=[x, y, 0.05], mass=0,
                          contype=0, conaffinity=FLOOR, condim=1, priority=1)
    return ["footprint", "left", "right"]


def add_arm(body, robot, payload, count):
    whole = robot.description
    arm = mujoco.MjSpec.from_string(whole["urdf_text"])
    root, tip = arm.bodies[1], arm.body(whole["arm"]["tip"])
    for joint in [joint for joint in arm.joints if joint.name not in robot.joints]:
        arm.delete(joint)  # Frankie's fingers, which are held at 0
    for link in arm.bodies[1:]:
        link.gravcomp = 1.0
    for joint in arm.joints:
        joint.actgravcomp = True  # it is part of the effort
        joint.limited = False     # a limit is the controller's to keep; `trials.py` ends a trial beyond it
    names = []
    for shape in whole["collision"]["shapes"]:
        names.append(f"{shape['link']} {count + len(names)}")
        meets = THING if shape["link"] == root.name else THING | FLOOR
        arm.body(shape["link"]).add_geom(name=names[-1], **solid(shape, mass=0, contype=ROBOT, conaffinity=meets),
                                         **at(shape["position"], shape["rotation"]))
    X_TE = np.linalg.inv(robot.fk(robot.ready, link=tip.name)) @ robot.fk(robot.ready)
    tip.add_site(name="tool", **at(X_TE[:3, 3], X_TE[:3, :3]))
    if payload > 0.0:  # a ball of water
        held = tip.add_body(name="payload", pos=X_TE[:3, 3])
        held.add_geom(type=GEOM["sphere"], size=[(payload * 0.75e-3 / np.pi) ** (1 / 3), 0, 0], mass=payload, contype=0, conaffinity=0)
    X_BR = robot.fk(robot.ready, link=root.name)
    body.add_frame(**at(X_BR[:3, 3], X_BR[:3, :3])).attach_body(root, "", "")
    return names


class Plant:
    """The true state, moved by commands of moma.Robot.velocities: (v, omega) of the base and the joints' rates."""

    def __init__(self, robot, world, *, payload=0.0, floor_friction=1.0, base_ramp=1.0, joint_friction=0.0, eye=(0, 0, 0.5)):
        base = robot.description["base"]
        self.wheels = base["wheels"]
        self.ramp = STEP * base_ramp * np.array(base["max_acceleration"])
        self.moving = np.zeros(2)  # (v, omega) that the base's own ramp has come to
        self.model = build(robot, world, payload, floor_friction, eye)
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in robot.joints]
        self.q_at = [int(joint.qposadr[0]) for joint in joints]
        self.v_at = [int(joint.dofadr[0]) for joint in joints]
        self.model.dof_frictionloss[self.v_at] = joint_friction * self.model.jnt_actfrcrange[[j.id for j in joints], 1]
        x, y, self.heading = world["start"]["base"]
        self.data.qpos[:7] = x, y, 0, np.cos(self.heading / 2), 0, 0, np.sin(self.heading / 2)
        self.data.qpos[self.q_at] = self.data.act[2:] = world["start"]["q"]
        names = [self.model.geom(i).name for i in range(self.model.ngeom)]
        self.rolls = np.array([name.startswith(("tread", "caster")) for name in names])
        mujoco.mj_forward(self.model, self.data)

    def advance(self, command, seconds):
        """Names of the two geoms that touched first on the way, else None."""
        for _ in range(round(seconds / STEP)):
            self.moving += np.clip(command[:2] - self.moving, -self.ramp, self.ramp)
            v, turn = self.moving[0], self.moving[1] * self.wheels["separation"] / 2
            rates = [(v - turn) / self.wheels["radius"], (v + turn) / self.wheels["radius"], *command[2:]]
            self.data.ctrl[:] = np.repeat(rates, 2)
            mujoco.mj_step(self.model, self.data)
            contact = self.data.contact
            touching = contact.geom[(contact.dist < 0.0) & ~self.rolls[contact.geom].any(axis=1)]
            if len(touching):
                return tuple(self.model.geom(i).name for i in touching[0])
        return None

    def base(self):
        """(x, y, phi), phi without jumps."""
        turn = 2 * np.arctan2(self.data.qpos[6], self.data.qpos[3]) - self.heading
        self.heading += np.remainder(turn + np.pi, 2 * np.pi) - np.pi
        return np.array([*self.data.qpos[:2], self.heading])

    def q(self):
        return self.data.qpos[self.q_at]

    def velocities(self):
        phi = self.base()[2]
        ahead = self.data.qvel[:2] @ [np.cos(phi), np.sin(phi)]
        return np.array([ahead, self.data.qvel[5], *self.data.qvel[self.v_at]])

    def sees(self, name, reach, axis, opening, hides):
        """Whether the camera, which looks along `axis` of the base with this opening angle, sees a thing no further than `reach`:
        its nearest point or its middle, and, where things hide, with nothing before it."""
        mujoco.mj_kinematics(self.model, self.data)
        eye, thing, points, hit = self.data.geom("eye"), self.model.geom(name).id, np.zeros(6), np.zeros(1, np.int32)
        if mujoco.mj_geomDistance(self.model, self.data, eye.id, thing, min(reach, 1e3), points) >= reach:
            return False
        looks_along = eye.xmat.reshape(3, 3) @ axis
        for point in (points[3:], self.data.geom_xpos[thing]):
            way = point - eye.xpos
            length = np.linalg.norm(way)
            if opening < 2 * np.pi and way @ looks_along < np.cos(opening / 2) * length * np.linalg.norm(axis):
                continue
            share = mujoco.mj_ray(self.model, self.data, eye.xpos, way, [1, 0, 0, 0, 0, 0], 1, -1, hit) if hides else -1
            if share < 0 or hit[0] == thing or share * length > length - 0.01:
                return True
        return False

    def tool(self):
        """Pose of E."""
        X = np.eye(4)
        mujoco.mj_kinematics(self.model, self.data)
        X[:3, 3], X[:3, :3] = self.data.site("tool").xpos, self.data.site("tool").xmat.reshape(3, 3)
        return X
