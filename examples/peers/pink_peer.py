"""pink on Pinocchio: a frame task on E with a posture task beside it, limits of joints and speeds, its barrier for the nearest pairs of
solids that can meet (with all of them a step takes several times as long). The gains are those of its example
barriers/kukas_self_collision.py. A differential drive turns and then drives along its heading; where the base is goes into its
first placement."""

import coal
import numpy as np
import pink
import pinocchio as pin

from parts import frame, mobile, mount, pairs, solids

SHAPES = {
    "sphere": lambda size: coal.Sphere(size[0]),
    "box": lambda size: coal.Box(*size),
    "capsule": lambda size: coal.Capsule(size[0], size[1]),
    "cylinder": lambda size: coal.Cylinder(size[0], size[1]),
}


def model_of(robot):
    whole = pin.buildModelFromXML(robot.description["urdf_text"])
    held = [i for i, name in enumerate(whole.names) if i > 0 and name not in robot.joints]
    arm = pin.buildReducedModel(whole, held, pin.neutral(whole))
    base, parent = pin.Model(), 0
    if mobile(robot):
        speed, far = robot.velocity_limits, np.r_[1e6]
        for joint, name, most in ((pin.JointModelRZ(), "@turn", speed[1]), (pin.JointModelPX(), "@drive", speed[0])):
            parent = base.addJoint(parent, joint, pin.SE3.Identity(), name, np.r_[1e3], np.r_[most], -far, far)
    body = base.addFrame(pin.Frame("@base", parent, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    model = pin.appendModel(base, arm, body, pin.SE3(mount(robot)))
    model.lowerPositionLimit[-len(robot.joints):] = robot.lower
    model.upperPositionLimit[-len(robot.joints):] = robot.upper
    model.velocityLimit[-len(robot.joints):] = robot.velocity_limits[-len(robot.joints):]
    return model


def geometry_of(robot, model, objects):
    geometry = pin.GeometryModel()
    for i, (link, kind, size, X) in enumerate(solids(robot)):
        place = model.frames[model.getFrameId("@base" if link is None else link)]
        solid = pin.GeometryObject(f"robot{i}", place.parentJoint, place.placement * pin.SE3(X), SHAPES[kind](size))
        geometry.addGeometryObject(solid)
    own = geometry.ngeoms
    for i, item in enumerate(objects):
        id = geometry.addGeometryObject(pin.GeometryObject(f"object{i}", 0, pin.SE3.Identity(), SHAPES[item.shape](item.size)))
        for solid in range(own):
            geometry.addCollisionPair(pin.CollisionPair(solid, id))
    for first, second in pairs(robot):
        geometry.addCollisionPair(pin.CollisionPair(first, second))
    return geometry, own


class Pink:
    def __init__(self, gain=1.0, position_cost=50.0, orientation_cost=10.0, posture_cost=1e-3, lm_damping=0.0,
                 avoidance=20.0, stop=0.05, nearest=20):
        self.task = {"gain": gain, "position_cost": position_cost, "orientation_cost": orientation_cost,
                     "lm_damping": lm_damping}
        self.posture_cost = posture_cost
        self.nearest = nearest
        self.barrier = {"gain": avoidance, "d_min": stop, "safe_displacement_gain": 1.0}

    def reset(self, robot, objects):
        self.robot = robot
        model = self.model = model_of(robot)
        self.geometry, self.own = geometry_of(robot, model, objects)
        self.tip = robot.description["arm"]["tip"]
        q = self.place(np.zeros(3), robot.ready)
        self.configuration = pink.Configuration(model, model.createData(), q, collision_model=self.geometry,
                                                collision_data=self.geometry.createData())
        self.tasks = [pink.FrameTask(self.tip, **self.task), pink.PostureTask(cost=self.posture_cost)]
        self.tasks[1].set_target_from_configuration(self.configuration)
        # Pairs that are too close to begin with could never be served: no step would have a solution. An SRDF leaves them out.
        near = self.configuration.collision_data.distanceResults
        for k in reversed(range(len(self.geometry.collisionPairs))):
            pair = self.geometry.collisionPairs[k]
            if pair.second < self.own and near[k].min_distance < self.barrier["d_min"]:
                self.geometry.removeCollisionPair(pair)
        self.configuration.collision_data = self.geometry.createData()
        count = min(self.nearest, len(self.geometry.collisionPairs))
        self.barriers = [pink.barriers.SelfCollisionBarrier(count, **self.barrier)]

    def place(self, base, q):
        if not mobile(self.robot):
            return np.array(q)
        self.model.jointPlacements[1] = pin.SE3(np.eye(3), np.r_[base[:2], 0.0])
        return np.r_[base[2], 0.0, q]

    def step(self, seen):
        for i, item in enumerate(seen.objects):
            self.geometry.geometryObjects[self.own + i].placement = pin.SE3(frame(item))
        self.configuration.update(self.place(seen.base, seen.q))
        self.tasks[0].set_target(pin.SE3(frame(seen.goal)))
        try:
            velocity = pink.solve_ik(self.configuration, self.tasks, self.robot.control_period, solver="daqp",
                                     barriers=self.barriers, safety_break=False)
        except pink.exceptions.PinkError:
            return {"command": np.zeros(len(self.robot.velocities)), "status": "infeasible", "fallback": "brake"}
        return np.r_[velocity[1], velocity[0], velocity[2:]] if mobile(self.robot) else velocity
