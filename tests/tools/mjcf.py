#!/usr/bin/env python3
"""Writes a robot as moma resolved it, link by link, as a model for MuJoCo.

    tests/tools/mjcf.py build/tests/physics_probe configs/robots/frankie.yaml > frankie.xml

Same masses, inertias, shapes, joints and step as the ODE plant's. What moma merges or derives on its own (rigid
links, the inertia of the base) is left to MuJoCo's compiler, so that a fault there shows as a difference.
"""
import argparse
import json
import math
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np

STEP = 0.002
# Contacts as stiff as MuJoCo's integrator bears (time constant of two steps), so that wheels neither sink nor creep.
STIFF = {"solref": f"{2 * STEP} 1", "solimp": "0.99 0.9999 0.0001"}

BASE_DRIVES = {"differential": ["@left", "@right"], "omnidirectional": ["@x", "@y", "@phi"]}


class Probe:
    """The C++ program that answers about moma's side (tests/world/probe)."""

    def __init__(self, program):
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, what, **request):
        self.process.stdin.write(json.dumps({"ask": what, **request}) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"the physics probe ended while it was asked for '{what}'")
        answer = json.loads(line)
        if "error" in answer:
            raise RuntimeError(f"{what}: {answer['error']}")
        return answer

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=60)


def text(values):
    return " ".join(repr(float(v)) for v in np.atleast_1d(np.asarray(values, dtype=float)).ravel())


def quaternion(R):
    """(w, x, y, z) of a rotation matrix; the largest component is taken from the diagonal."""
    R = np.asarray(R, dtype=float).reshape(3, 3)
    diagonal = np.array([np.trace(R), R[0, 0], R[1, 1], R[2, 2]])
    i = int(np.argmax(diagonal))
    q = np.empty(4)
    if i == 0:
        q[:] = [1 + np.trace(R), R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    else:
        a = i - 1
        b, c = (a + 1) % 3, (a + 2) % 3
        q[0] = R[c, b] - R[b, c]
        q[1 + a] = 1 + R[a, a] - R[b, b] - R[c, c]
        q[1 + b] = R[a, b] + R[b, a]
        q[1 + c] = R[a, c] + R[c, a]
    return q / np.linalg.norm(q)


def transform(pose):
    X = np.eye(4)
    X[:3, :3] = np.asarray(pose["rotation"]).reshape(3, 3)
    X[:3, 3] = pose["position"]
    return X


def placed(X):
    return {"pos": text(X[:3, 3]), "quat": text(quaternion(X[:3, :3]))}


def held_displacement(link):
    """What a movable joint that is held adds to its link's pose."""
    X = np.eye(4)
    axis = np.asarray(link["axis"])
    if link["type"] == "prismatic":
        X[:3, 3] = link["held"] * axis
    elif link["type"] in ("revolute", "continuous"):
        K = np.cross(axis, np.eye(3)).T  # K v = axis x v
        X[:3, :3] += math.sin(link["held"]) * K + (1 - math.cos(link["held"])) * K @ K
    return X


def geom_size(kind, size):
    if kind == "sphere":
        return text(size[0])
    if kind == "box":
        return text(np.asarray(size) / 2)
    if kind in ("capsule", "cylinder"):
        return text([size[0], size[1] / 2])
    raise SystemExit(f"shape '{kind}' has no counterpart that would be the same solid in MuJoCo")


def volume(kind, size):
    if kind == "sphere":
        return 4 / 3 * math.pi * size[0] ** 3
    if kind == "box":
        return float(np.prod(size))
    caps = 4 / 3 * math.pi * size[0] ** 3 if kind == "capsule" else 0.0
    return math.pi * size[0] ** 2 * size[1] + caps


def add_links(robot, world, held):
    """Bodies nested as the links are. Robot geoms meet objects only: bit 1 against bit 2."""
    shapes = [s for s in robot["shapes"] if not (held and s["kind"] == "convex")]  # then only the arm's dynamics
    base_volume = sum(volume(s["kind"], s["size"]) for s in shapes if s["link"] == 0)
    base_mass = max(0.0, robot["base"]["mass"] - 2 * robot["support"]["wheel_mass"])
    bodies = []
    for i, link in enumerate(robot["links"]):
        parent = world if link["parent"] < 0 else bodies[link["parent"]]
        X = transform(link["X_PJ"])
        if "joint" not in link:
            X = X @ held_displacement(link)
        body = ET.SubElement(parent, "body", name=f"{link['name']}/{i}" if i else "@base", **placed(X))
        bodies.append(body)
        if i == 0 and not held:
            if robot["base"]["type"] == "omnidirectional":
                for name, kind, axis in (("x", "slide", "1 0 0"), ("y", "slide", "0 1 0"), ("phi", "hinge", "0 0 1")):
                    ET.SubElement(body, "joint", name=f"@{name}", type=kind, axis=axis)
            else:
                ET.SubElement(body, "freejoint", name="@free")
        if "joint" in link:
            kind = "slide" if link["type"] == "prismatic" else "hinge"
            ET.SubElement(body, "joint", name=link["joint"]["name"], type=kind, axis=text(link["axis"]))
        if "inertial" in link:
            I = np.asarray(link["inertial"]["inertia"]).reshape(3, 3)
            point = not np.any(I)  # frames and sensors of real files: without extent, or without mass, too
            inertia = {"diaginertia": "0 0 0"} if point else {
                "fullinertia": text([I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]])}
            ET.SubElement(body, "inertial", pos=text(link["inertial"]["com"]), mass=text(link["inertial"]["mass"]),
                          **inertia)
        for shape in shapes:
            if shape["link"] != i:
                continue
            mass = base_mass * volume(shape["kind"], shape["size"]) / base_volume if i == 0 else 0.0
            ET.SubElement(body, "geom", name=shape["name"], type=shape["kind"], size=geom_size(shape["kind"], shape["size"]),
                          contype="1", conaffinity="2", friction=text([robot["object_friction"], 0, 0]),
                          mass=text(mass), **placed(transform(shape["X_LS"])))
    return bodies


def add_wheels(robot, base, contact):
    support = robot["support"]
    wheels = support["wheels"]
    for name, side in (("left", 0.5), ("right", -0.5)):
        wheel = ET.SubElement(base, "body", name=f"@{name}", pos=text([0, side * wheels["separation"], wheels["radius"]]))
        ET.SubElement(wheel, "joint", name=f"@{name}", type="hinge", axis="0 1 0")
        ET.SubElement(wheel, "geom", name=f"@{name}", type="sphere", size=text(wheels["radius"]),
                      mass=text(support["wheel_mass"]), contype="0", conaffinity="0")
        mu = robot["wheel_friction"]
        ET.SubElement(contact, "pair", geom1=f"@{name}", geom2="@floor", condim="3", friction=text([mu, mu, 0, 0, 0]),
                      **STIFF)
    for i, (x, y) in enumerate(support["casters"]):
        ET.SubElement(base, "geom", name=f"@caster{i}", type="sphere", size=text(support["caster_radius"]), mass="0",
                      pos=text([x, y, support["caster_radius"]]), contype="0", conaffinity="0")
        ET.SubElement(contact, "pair", geom1=f"@caster{i}", geom2="@floor", condim="1", **STIFF)


def add_drives(robot, root, held):
    """A drive on each wheel and joint: a constraint of the joint to a value that Drives moves along. MuJoCo has no
    velocity motor within its constraint solver, and a servo stiff enough outside of it fights the wheels' friction."""
    equality = ET.SubElement(root, "equality")
    names = [link["joint"]["name"] for link in robot["links"] if "joint" in link]
    if not held:
        names = BASE_DRIVES.get(robot["base"]["type"], []) + names
    for name in names:
        ET.SubElement(equality, "joint", name=name, joint1=name, polycoef="0 0 0 0 0", solref=STIFF["solref"],
                      solimp="0.9999 0.9999 0.001")


def mjcf(robot, held=False, objects=(), driven=True, step=STEP, own_contacts=False, defaults=False):
    """The model's text. `held` bolts the base to the world; `own_contacts` adds the pairs of robot shapes that moma
    checks for self-collision, and the arm's against the floor (for cost: the same pairs as moma's); `defaults` leaves
    MuJoCo's solver as it comes: quicker, and wheels that creep."""
    held = held or robot["base"]["type"] == "fixed"
    root = ET.Element("mujoco", model=robot["name"])
    ET.SubElement(root, "compiler", angle="radian", fusestatic="false", inertiafromgeom="auto", autolimits="true")
    solver = {} if defaults else {"cone": "elliptic", "impratio": "100", "tolerance": "1e-12"}
    ET.SubElement(root, "option", timestep=text(step), gravity=text([0, 0, -robot["gravity"]]), integrator="Euler",
                  **solver)
    world = ET.SubElement(root, "worldbody")
    contact = ET.SubElement(root, "contact")
    ET.SubElement(world, "geom", name="@floor", type="plane", size="0 0 1", contype="0", conaffinity="0")
    for i, item in enumerate(objects):
        parent = world
        if "velocity" in item:
            parent = ET.SubElement(world, "body", name=f"object{i}", mocap="true", pos=text(item["position"]),
                                   quat=text(item["quaternion"]))
        ET.SubElement(parent, "geom", name=f"object{i}", type=item["kind"], size=geom_size(item["kind"], item["size"]),
                      contype="2", conaffinity="1", friction=text([robot["object_friction"], 0, 0]),
                      **({} if "velocity" in item else {"pos": text(item["position"]), "quat": text(item["quaternion"])}))
    bodies = add_links(robot, world, held)
    if robot["base"]["type"] == "differential" and not held:
        add_wheels(robot, bodies[0], contact)
    if own_contacts:
        for first, second in robot["self_pairs"]:
            ET.SubElement(contact, "pair", geom1=robot["shapes"][first]["name"], geom2=robot["shapes"][second]["name"])
        for shape in robot["shapes"]:
            if not shape["rigid_with_base"]:
                ET.SubElement(contact, "pair", geom1=shape["name"], geom2="@floor")
    if driven:
        add_drives(robot, root, held)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("probe", help="build/tests/physics_probe")
    parser.add_argument("robot", help="robot file (YAML)")
    parser.add_argument("--held", action="store_true", help="bolt the base to the world")
    arguments = parser.parse_args()
    probe = Probe(arguments.probe)
    print(mjcf(probe.ask("model", robot=arguments.robot), held=arguments.held))
    probe.close()


if __name__ == "__main__":
    sys.exit(main())
