"""Makes policy-frankie.onnx and policy-panda.onnx: a network of two layers learns what moma's `rrmc` commands in the open, by
imitation where the policy itself has come to (DAgger: Ross, Gordon, Bagnell 2011). Takes some minutes; needs moma, gymnasium, onnx
and what requirements.txt lists.

    python3 examples/peers/train_policy.py [FOLDER]
"""

import os
import sys

import moma
import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from policy import FEATURES, features

HERE = os.path.dirname(os.path.abspath(__file__))
CONFIGS = os.path.join(HERE, "..", "..", "configs")
ROUNDS, ENVS, STEPS, WIDTH = 5, 64, 300, 128


class Network:
    """tanh(tanh(x A + a) B + b) C + c, by Adam on the mean square."""

    def __init__(self, inputs, outputs, rng):
        sizes = [inputs, WIDTH, WIDTH, outputs]
        self.parts = []
        for i, j in zip(sizes, sizes[1:]):
            self.parts += [rng.normal(0, 1 / np.sqrt(i), (i, j)).astype(np.float32), np.zeros(j, np.float32)]
        self.first = [np.zeros_like(p) for p in self.parts]
        self.second = [np.zeros_like(p) for p in self.parts]
        self.count = 0

    def layers(self, x):
        A, a, B, b, C, c = self.parts
        h = np.tanh(x @ A + a)
        g = np.tanh(h @ B + b)
        return h, g, g @ C + c

    def learn(self, x, y, rate):
        A, a, B, b, C, c = self.parts
        h, g, out = self.layers(x)
        d = 2 * (out - y) / len(x)
        e = d @ C.T * (1 - g * g)
        f = e @ B.T * (1 - h * h)
        self.count += 1
        for k, grad in enumerate([x.T @ f, f.sum(0), h.T @ e, e.sum(0), g.T @ d, d.sum(0)]):
            self.first[k] += 0.1 * (grad - self.first[k])
            self.second[k] += 0.001 * (grad * grad - self.second[k])
            low, high = 1 - 0.9**self.count, 1 - 0.999**self.count
            self.parts[k] -= (rate * (self.first[k] / low) / (np.sqrt(self.second[k] / high) + 1e-8)).astype(np.float32)

    def save(self, file, made_by):
        names = ["A", "a", "B", "b", "C", "c"]
        nodes = [helper.make_node("Gemm", ["features", "A", "a"], ["h"]), helper.make_node("Tanh", ["h"], ["hh"]),
                 helper.make_node("Gemm", ["hh", "B", "b"], ["g"]), helper.make_node("Tanh", ["g"], ["gg"]),
                 helper.make_node("Gemm", ["gg", "C", "c"], ["command"])]
        ends = [helper.make_tensor_value_info(name, TensorProto.FLOAT, [None, size])
                for name, size in (("features", len(self.parts[0])), ("command", len(self.parts[-1])))]
        graph = helper.make_graph(nodes, "policy", ends[:1], ends[1:], [numpy_helper.from_array(p, n) for p, n in zip(self.parts, names)])
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8, doc_string=made_by)
        onnx.checker.check_model(model)
        onnx.save(model, file)


def train(robot, folder):
    # Other worlds than those of configs/suites/peers.yaml.
    suite = {"name": robot, "robot": os.path.join(CONFIGS, f"robots/{robot}.yaml"), "worlds": {"seed": 1001, "families": {"open": {}}},
             "controllers": {"outside": os.path.join(CONFIGS, "controllers/rrmc.yaml")},
             "simulation": {"mode": "kinematic", "time_limit": 20}, "trials": 100_000}
    env = moma.VectorEnv(suite, ENVS, threads=1, objects=0)
    limits, rng = env.robot.velocity_limits, np.random.default_rng(7)
    file = os.path.join(CONFIGS, "controllers/rrmc.yaml")
    teachers = [moma.Controller(env.robot, file, env.control_period) for _ in range(ENVS)]
    network = Network(len(env.robot.joints) + FEATURES, len(limits), rng)
    shown, right = [], []
    for turn in range(ROUNDS):
        seen, _ = env.reset(seed=turn)
        successes = ends = 0
        for step in range(STEPS):
            X_WG = np.tile(np.eye(4), (ENVS, 1, 1))
            X_WG[:, :3, 3], X_WG[:, :3, :3] = seen["goal"][:, :3], seen["goal"][:, 3:12].reshape(-1, 3, 3)
            x, size = features(seen["base"], seen["q"], env.robot.fk(seen["q"], seen["base"]), X_WG)
            y = np.array([teacher.step(env.seen(i)).command for i, teacher in enumerate(teachers)])
            shown.append(x)
            right.append((y / size).astype(np.float32))
            command = y if turn == 0 else network.layers(x)[2].astype(float) * size
            seen, _, terminated, truncated, infos = env.step(np.clip(command, -limits, limits))
            ends += int((terminated | truncated).sum())
            successes += sum(o == "success" for o in infos.get("outcome", ()))
        X, Y = np.concatenate(shown), np.concatenate(right)
        count = 12 if turn < ROUNDS - 1 else 40
        for epoch in range(count):
            rate = 2e-3 * 0.5 * (1 + np.cos(np.pi * epoch / count)) + 1e-5
            for rows in np.array_split(rng.permutation(len(X)), len(X) // 512):
                network.learn(X[rows], Y[rows], rate)
        left = float(np.sqrt(np.mean((network.layers(X)[2] - Y) ** 2)))
        print(f"{robot}: round {turn}, {len(X)} states, {successes} of {ends} trials arrived, error {left:.4f}", flush=True)
    network.save(os.path.join(folder, f"policy-{robot}.onnx"), f"imitates rrmc of moma on {robot}; train_policy.py")


if __name__ == "__main__":
    for robot in ("frankie", "panda"):
        train(robot, sys.argv[1] if len(sys.argv) > 1 else HERE)
