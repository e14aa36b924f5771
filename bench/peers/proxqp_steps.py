"""The holistic controller by hand: kinematics of Pinocchio, distances of coal, ProxQP; Python between them."""
from importlib.metadata import version

import numpy as np
import pinocchio as pin
import proxsuite

from common import angle, pose, run
from pinned import nearest, place, robot

ROWS = 60  # for pairs of solids within their influence, nearest first
OBJECT, OWN = (0.3, 0.05), (0.1, 0.01)  # influence, stop [m]


def manipulability_gradient(J):
    """Of sqrt(det Jv Jv^T), arm's columns in world axes (Haviland & Corke 2020)."""
    Jv, Jw = J[:3].T, J[3:].T
    n = len(Jv)
    cross = np.cross(Jw[:, None, :], Jv[None, :, :])  # [j, i]: axis j on column i
    lower = np.tril(np.ones((n, n), bool))
    H = np.where(lower.T[:, :, None], cross, cross.transpose(1, 0, 2))  # dJv_i / dq_j
    M = Jv.T @ Jv
    m = np.sqrt(max(np.linalg.det(M), 0.0))
    return m * np.einsum("ia,ab,jib->j", Jv, np.linalg.inv(M), H)


def make(scene):
    model, geometry, E = robot(scene)
    data, near = model.createData(), geometry.createData()
    objects, nv, dof = len(scene["objects"]), model.nv, model.nv - len(scene["model"]["joints"])
    n, goal = nv + 6, pose(scene["goal"])
    most = np.r_[model.velocityLimit, 10 * np.ones(6)]
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    qp = proxsuite.proxqp.dense.QP(n, 6, ROWS, True)
    qp.settings.eps_abs, qp.settings.max_iter = 1e-5, 100
    qp.settings.initial_guess = proxsuite.proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
    started = False

    def pair_rows(q, C, u):
        pin.computeDistances(model, data, geometry, near, q)
        d = np.array([r.min_distance for r in near.distanceResults])
        influence = np.where([p.second >= geometry.ngeoms - objects for p in geometry.collisionPairs], OBJECT[0], OWN[0])
        used = np.flatnonzero(d < influence)
        used = used[np.argsort(d[used])][:ROWS]
        for row, k in enumerate(used):
            pair, result = geometry.collisionPairs[int(k)], near.distanceResults[int(k)]
            p = [result.getNearestPoint1(), result.getNearestPoint2()]
            normal = (p[1] - p[0]) / (np.linalg.norm(p[1] - p[0]) or 1.0) * (1 if d[k] >= 0 else -1)
            relative = np.zeros(nv)
            for side, geom in ((1.0, pair.first), (-1.0, pair.second)):
                joint = geometry.geometryObjects[geom].parentJoint
                if joint == 0:
                    continue
                J = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
                lever = p[0 if side > 0 else 1] - data.oMi[joint].translation
                relative += side * (normal @ J[:3] + np.cross(lever, normal) @ J[3:])
            di, ds = OBJECT if influence[k] == OBJECT[0] else OWN
            C[row, :nv], u[row] = relative, (d[k] - ds) / (di - ds)

    def step(base, q_arm):
        nonlocal started
        q = place(model, base, q_arm)
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        X = data.oMf[E]
        J = pin.getFrameJacobian(model, data, E, pin.LOCAL_WORLD_ALIGNED)
        e_p, e_R = goal[:3, 3] - X.translation, pin.log3(goal[:3, :3] @ X.rotation.T)
        e = max(np.sum(np.abs(e_p)), 1e-2)
        H = np.r_[np.full(dof, 1 / e), np.full(nv - dof, 0.01), np.full(6, 1 / e)]
        g = np.r_[np.zeros(dof), -manipulability_gradient(J[:, dof:]), np.zeros(6)]
        if dof:
            arm = X.translation - [base[0], base[1], 0.0]
            g[0] = -0.5 * np.arctan2(np.sin(t := np.arctan2(arm[1], arm[0]) - base[2]), np.cos(t))
        high, low = most.copy(), -most
        high[dof:nv] = np.minimum(high[dof:nv], (upper[dof:] - q[dof:] - 0.1) / 0.8)
        low[dof:nv] = np.maximum(low[dof:nv], (lower[dof:] - q[dof:] + 0.1) / 0.8)
        C, u = np.zeros((ROWS, n)), np.full(ROWS, 1e20)
        pair_rows(q, C, u)
        parts = (np.diag(H), g, np.c_[J, np.eye(6)], np.r_[1.5 * e_p, 1.95 * e_R], C, np.full(ROWS, -1e20), u, low, high)
        qp.update(*parts) if started else qp.init(*parts)
        started = True
        qp.solve()
        x = qp.results.x[:nv]
        velocity = np.r_[x[1], x[0], x[2:]] if dof else x
        return velocity, np.linalg.norm(e_p), angle(X.rotation.T @ goal[:3, :3])

    def look():
        J = pin.getFrameJacobian(model, data, E, pin.LOCAL_WORLD_ALIGNED)[:3, dof:]
        return *nearest(scene, geometry, near), np.sqrt(max(np.linalg.det(J @ J.T), 0.0))

    step.look = look
    return step


if __name__ == "__main__":
    run(make, f"Pinocchio {pin.__version__}, ProxQP {version('proxsuite')}, coal {version('coal')}")
