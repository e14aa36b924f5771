"""The scene's robot in Pinocchio: moma's URDF on a base that turns and then drives, its shapes and the objects in coal."""
import coal
import numpy as np
import pinocchio as pin

from common import pose, planar


def solid(kind, size):
    if kind == "sphere":
        return coal.Sphere(size[0])
    if kind == "box":
        return coal.Box(*size)
    return coal.Capsule(size[0], size[1])


def robot(scene):
    """(model, geometry, frame of E); q is (phi, 0, joints): the base's position goes into its first placement."""
    file = scene["model"]
    whole = pin.buildModelFromUrdf(scene["urdf"])
    names = set(file["joints"])
    locked = [i for i, name in enumerate(whole.names) if i > 0 and name not in names]
    arm = pin.buildReducedModel(whole, locked, pin.neutral(whole))
    base = pin.Model()
    mobile = file["base"]["type"] != "fixed"
    parent = 0
    if mobile:
        parent = base.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "turn", np.r_[1e3], np.r_[file_speed(scene)[1]],
                               np.r_[-1e6], np.r_[1e6])
        parent = base.addJoint(parent, pin.JointModelPX(), pin.SE3.Identity(), "drive", np.r_[1e3],
                               np.r_[file_speed(scene)[0]], np.r_[-1e6], np.r_[1e6])
    frame = base.addFrame(pin.Frame("@base", parent, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    model = pin.appendModel(base, arm, frame, pin.SE3(mount(scene)))
    geometry = pin.GeometryModel()
    for item in file["shapes"]:
        link = file["links"][item["link"]]
        id = model.getFrameId(link["name"]) if item["link"] else frame
        place = model.frames[id]
        geometry.addGeometryObject(pin.GeometryObject(
            item["name"], place.parentJoint, place.placement * pin.SE3(pose(item["X_LS"])), solid(item["kind"], item["size"])))
    shapes = geometry.ngeoms
    for item in scene["objects"]:
        id = geometry.addGeometryObject(pin.GeometryObject(item["name"], 0, pin.SE3(pose(item)), solid(item["shape"], item["size"])))
        for i in range(shapes):
            geometry.addCollisionPair(pin.CollisionPair(i, id))
    for first, second in file["self_pairs"]:
        geometry.addCollisionPair(pin.CollisionPair(first, second))
    return model, geometry, model.getFrameId(scene["tip"])


def file_speed(scene):
    return scene["model"]["base"]["max_speed"]


def mount(scene):
    """Of the URDF's root on the base."""
    return pose(scene["model"]["links"][1]["X_PJ"]) if scene["model"]["base"]["type"] != "fixed" else np.eye(4)


def place(model, base, q):
    """Puts the base where it is; the configuration for that."""
    if model.nq == len(q):
        return np.array(q)
    model.jointPlacements[1] = pin.SE3(planar([base[0], base[1], 0.0]))
    return np.r_[base[2], 0.0, q]


def nearest(scene, geometry, near):
    """Least distances to objects and to itself among the results that the last step asked coal for: pairs with objects
    come first."""
    d = [result.min_distance for result in near.distanceResults]
    own = len(scene["model"]["self_pairs"])
    return min(d[:len(d) - own], default=np.inf), min(d[len(d) - own:], default=np.inf)
