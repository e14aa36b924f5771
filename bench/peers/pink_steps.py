"""pink on Pinocchio: a frame task on E, limits of joints and speeds, its barrier for the 20 nearest pairs of solids."""
from importlib.metadata import version

import numpy as np
import pink
import pinocchio as pin

from common import PERIOD, angle, pose, run
from pinned import nearest, place, robot

RATE = 1.5  # of the error [1/s]


def make(scene):
    model, geometry, E = robot(scene)
    data, near = model.createData(), geometry.createData()
    mobile = scene["model"]["base"]["type"] != "fixed"
    start = scene["states"][0]
    q0 = place(model, start["base"], start["q"])
    configuration = pink.Configuration(model, data, q0, collision_model=geometry, collision_data=near)
    task = pink.FrameTask(model.frames[E].name, position_cost=1.0, orientation_cost=1.0, lm_damping=1e-3,
                          gain=RATE * PERIOD)
    goal = pose(scene["goal"])
    task.set_target(pin.SE3(goal))
    pairs = min(20, len(geometry.collisionPairs))
    barrier = pink.barriers.SelfCollisionBarrier(n_collision_pairs=pairs, gain=4.0, safe_displacement_gain=0.0, d_min=0.01)
    limits = [pink.limits.ConfigurationLimit(model), pink.limits.VelocityLimit(model)]

    def step(base, q):
        configuration.update(place(model, base, q))
        X = configuration.get_transform_frame_to_world(model.frames[E].name).homogeneous
        try:
            velocity = pink.solve_ik(configuration, [task], PERIOD, solver="daqp", damping=1e-3, limits=limits,
                                     barriers=[barrier])
        except pink.exceptions.PinkError:
            velocity = np.zeros(model.nv)
        if mobile:
            velocity = np.r_[velocity[1], velocity[0], velocity[2:]]
        return velocity, np.linalg.norm(X[:3, 3] - goal[:3, 3]), angle(X[:3, :3].T @ goal[:3, :3])

    def look():
        J = configuration.get_frame_jacobian(model.frames[E].name)[:3, model.nv - len(start["q"]):]
        return *nearest(scene, geometry, near), np.sqrt(max(np.linalg.det(J @ J.T), 0.0))

    step.look = look
    return step


if __name__ == "__main__":
    run(make, f"pink {version('pin-pink')}, Pinocchio {pin.__version__}, DAQP {version('daqp')}")
