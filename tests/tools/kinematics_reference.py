#!/usr/bin/env python3
"""Reference kinematics by Pinocchio, independent of moma, for tests/controller/kinematics_reference_test.cc.

    python3 -m venv VENV && VENV/bin/pip install pin==4.1.0 example-robot-data==6.0.0
    VENV/bin/python tests/tools/kinematics_reference.py > tests/data/kinematics_reference.json

Six-vectors are [angular; linear] in world axes at the end effector; `hessian` holds the derivatives of the arm's
Jacobian by each of its joints, one matrix after the other. A differential base is Pinocchio's planar joint with its
sideways column left out. Positions are those of a robot whose URDF root is mounted at the base's origin.
"""
import json
import os
import random
import sys

import numpy as np
import pinocchio as pin

ROBOTS = [
    {"file": "configs/robots/examples/panda.yaml", "urdf": "panda_description/urdf/panda.urdf", "tip": "panda_hand_tcp",
     "joints": [f"panda_joint{i}" for i in range(1, 8)]},
    {"file": "configs/robots/examples/ur5.yaml", "urdf": "ur_description/urdf/ur5_joint_limited_robot.urdf",
     "tip": "tool0", "joints": ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint",
                                "wrist_2_joint", "wrist_3_joint"]},
    {"file": "configs/robots/examples/tiago.yaml", "urdf": "tiago_description/robots/tiago_no_hand.urdf",
     "tip": "arm_tool_link", "base": "differential",
     "joints": ["torso_lift_joint"] + [f"arm_{i}_joint" for i in range(1, 8)]},
    {"file": "tests/data/robots/pr2_right_arm.yaml", "urdf": "pr2_description/urdf/pr2.urdf",
     "tip": "r_gripper_tool_frame", "held": {"torso_lift_joint": 0.16825},
     "joints": ["r_shoulder_pan_joint", "r_shoulder_lift_joint", "r_upper_arm_roll_joint", "r_elbow_flex_joint",
                "r_forearm_roll_joint", "r_wrist_flex_joint", "r_wrist_roll_joint"]},
    {"file": "tests/data/robots/talos_left_arm.yaml", "urdf": "talos_data/robots/talos_reduced.urdf",
     "tip": "gripper_left_base_link",
     "joints": ["torso_1_joint", "torso_2_joint"] + [f"arm_left_{i}_joint" for i in range(1, 8)]},
]


def data_folder():
    for base in sys.path:
        folder = os.path.join(base, "cmeel.prefix/share/example-robot-data/robots")
        if os.path.isdir(folder):
            return folder
    sys.exit("example-robot-data is not installed here")


def volume(J):
    return float(np.prod(np.linalg.svd(J, compute_uv=False)[: J.shape[0]]))


def tip_jacobian(model, data, q, frame, columns):
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    return np.vstack([J[3:], J[:3]])[:, columns]


def arm_hessian(model, data, q, frame, columns):
    """d(J of the tip)/dq by Pinocchio's kinematic Hessian, which is taken at the last joint's origin: the lever from
    there to the tip, r, adds d(w_i x r)/dq_j = dw_i/dq_j x r + w_i x (w_j x r)."""
    joint = model.frames[frame].parentJoint
    pin.computeJointJacobians(model, data, q)
    pin.computeJointKinematicHessians(model, data)
    pin.updateFramePlacements(model, data)
    # 6 x column x by joint; the tensor's memory is column by column, while numpy is told otherwise.
    tensor = np.array(pin.getJointKinematicHessian(model, data, joint, pin.LOCAL_WORLD_ALIGNED))
    H = tensor.ravel(order="K").reshape(tensor.shape, order="F")
    J = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
    r = data.oMf[frame].translation - data.oMi[joint].translation
    out = []
    for j in columns:
        D = np.zeros((6, len(columns)))
        for k, i in enumerate(columns):
            D[:3, k] = H[3:, i, j]
            D[3:, k] = H[:3, i, j] + np.cross(H[3:, i, j], r) + np.cross(J[3:, i], np.cross(J[3:, j], r))
        out.append(D)
    # The convention is checked here, so that a wrong reading of Pinocchio's manual cannot become the reference.
    h = 1e-6
    for D, j in zip(out, columns):
        v = np.zeros(model.nv)
        v[j] = h
        ahead = tip_jacobian(model, data, pin.integrate(model, q, v), frame, columns)
        behind = tip_jacobian(model, data, pin.integrate(model, q, -v), frame, columns)
        assert np.abs((ahead - behind) / (2 * h) - D).max() < 1e-7, "not the derivative of the Jacobian"
    tip_jacobian(model, data, q, frame, columns)
    return out


def set_joint(model, q, name, value):
    joint = model.joints[model.getJointId(name)]
    if joint.nq == 2:  # continuous
        q[joint.idx_q: joint.idx_q + 2] = [np.cos(value), np.sin(value)]
    else:
        q[joint.idx_q] = value


def cases_of(robot, rng):
    path = os.path.join(data_folder(), robot["urdf"])
    mobile = robot.get("base") == "differential"
    model = pin.buildModelFromUrdf(path, pin.JointModelPlanar()) if mobile else pin.buildModelFromUrdf(path)
    data = model.createData()
    frame = model.getFrameId(robot["tip"])
    cases = []
    for _ in range(8):
        q = pin.neutral(model)
        base = [rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-4, 4)] if mobile else [0.0, 0.0, 0.0]
        if mobile:
            q[0:4] = [base[0], base[1], np.cos(base[2]), np.sin(base[2])]
        for name, value in robot.get("held", {}).items():
            set_joint(model, q, name, value)
        values = []
        for name in robot["joints"]:
            joint = model.joints[model.getJointId(name)]
            low, high = (-np.pi, np.pi) if joint.nq == 2 else (model.lowerPositionLimit[joint.idx_q],
                                                               model.upperPositionLimit[joint.idx_q])
            values.append(rng.uniform(low, high))
            set_joint(model, q, name, values[-1])
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        X = data.oMf[frame].copy()
        J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        J = np.vstack([J[3:], J[:3]])
        arm = J[:, [model.joints[model.getJointId(n)].idx_v for n in robot["joints"]]]
        columns = [model.joints[model.getJointId(n)].idx_v for n in robot["joints"]]
        hessian = arm_hessian(model, data, q, frame, columns) if len(cases) < 3 else []  # it is long
        full = np.hstack([J[:, [0, 2]], arm]) if mobile else arm
        cases.append({
            "base": base, "q": values,
            "position": X.translation.tolist(), "rotation": X.rotation.flatten().tolist(),
            "jacobian": full.flatten().tolist(),
            **({"hessian": [float(v) for D in hessian for v in D.flatten()]} if hessian else {}),
            "manipulability": {"translation": volume(arm[3:]), "rotation": volume(arm[:3]), "all": volume(arm)},
        })
    return cases


def main():
    rng = random.Random(20210907)
    out = {"origin": f"tests/tools/kinematics_reference.py, Pinocchio {pin.__version__}, example-robot-data 6.0.0; "
                     "matrices row by row",
           "robots": [{"file": r["file"], "joints": r["joints"], "cases": cases_of(r, rng)} for r in ROBOTS]}
    json.dump(out, sys.stdout, indent=None, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
