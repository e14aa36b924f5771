"""Resolved motion rate with damping, over base and arm: the textbook's controller in a few lines, by the package moma.

    qdot = J^T (J J^T + damping^2 I)^-1 gain e,    e = [rotation vector; position] from E to the goal

(Nakamura & Hanafusa, J. Dyn. Sys. Meas. Control 108(3), 1986.) It knows no obstacles and no limits.
"""

import numpy as np

import moma


class ResolvedRate:
    def __init__(self, gain=1.0, damping=0.05):
        self.gain = gain  # [1/s]
        self.damping = damping

    def reset(self, robot, objects):
        self.robot = moma.Robot(robot.description)

    def step(self, seen):
        pose = self.robot.fk(seen.q, seen.base)
        error = np.concatenate([rotation_vector(seen.goal.rotation @ pose[:3, :3].T), seen.goal.position - pose[:3, 3]])
        J = self.robot.jacobian(seen.q, seen.base)
        return J.T @ np.linalg.solve(J @ J.T + self.damping**2 * np.eye(6), self.gain * error)


def rotation_vector(R):
    """Of a rotation by less than pi."""
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine, cosine = np.linalg.norm(axis), np.trace(R) - 1.0
    return axis * (np.arctan2(sine, cosine) / sine if sine > 1e-12 else 0.5)
