"""A learned policy from a file, by ONNX Runtime: policy-frankie.onnx or policy-panda.onnx, which train_policy.py beside it makes. A
small network that imitates moma's `rrmc`, resolved rates, where there are no objects: it looks at none, nor at joint limits."""

import functools
import os

import numpy as np
import onnxruntime
import pinocchio as pin

from parts import frame
from pink_peer import model_of

FEATURES = 7  # besides the joints


@functools.lru_cache
def network(file):
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(file, options, providers=["CPUExecutionProvider"])


def features(base, q, X_WE, X_WG):
    """What the network is shown of N states, (N, joints + FEATURES): the joints, which way E has to turn and to move in the base's axes as
    one direction, and how far; and that size itself, (N, 1). The network says the command per size."""
    c, s, zero, one = np.cos(base[:, 2]), np.sin(base[:, 2]), np.zeros(len(base)), np.ones(len(base))
    R_BW = np.stack([c, s, zero, -s, c, zero, zero, zero, one], axis=1).reshape(-1, 3, 3)
    way = np.einsum("nij,nj->ni", R_BW, X_WG[:, :3, 3] - X_WE[:, :3, 3])
    R = R_BW @ X_WG[:, :3, :3] @ X_WE[:, :3, :3].transpose(0, 2, 1) @ R_BW.transpose(0, 2, 1)
    axis = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arctan2(sine, 0.5 * (np.einsum("nii->n", R)[:, None] - 1))
    error = np.concatenate([axis * angle / np.maximum(sine, 1e-9), way], axis=1)
    size = np.linalg.norm(error, axis=1, keepdims=True) + 1e-6
    return np.concatenate([q, 2 * error / size, np.tanh(size / 2)], axis=1).astype(np.float32), size


class Policy:
    def __init__(self, folder=""):
        self.folder = folder or os.path.dirname(os.path.abspath(__file__))

    def reset(self, robot, objects):
        self.robot, self.tip = robot, robot.description["arm"]["tip"]
        self.network = network(os.path.join(self.folder, f"policy-{robot.name}.onnx"))
        self.model = model_of(robot)
        self.data = self.model.createData()
        self.id = self.model.getFrameId(self.tip)

    def step(self, seen):
        held = self.model.nq - len(seen.q)  # of the base, which is placed afterwards
        pin.forwardKinematics(self.model, self.data, np.r_[np.zeros(held), seen.q])
        X_BE = pin.updateFramePlacement(self.model, self.data, self.id).homogeneous
        X_WB = np.eye(4)
        c, s = np.cos(seen.base[2]), np.sin(seen.base[2])
        X_WB[:2, :2], X_WB[:2, 3] = [[c, -s], [s, c]], seen.base[:2]
        shown, size = features(seen.base[None], seen.q[None], (X_WB @ X_BE)[None], frame(seen.goal)[None])
        return self.network.run(None, {"features": shown})[0][0].astype(float) * size[0]
