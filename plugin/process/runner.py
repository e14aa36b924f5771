"""Runs a controller that is a Python class for moma (method: python): docs/how-to/python-controller.md.

moma starts `python3 -c THIS FILE.py CLASS` once for each worker and speaks docs/reference/process-protocol.md with it over
its standard input and output. The standard library suffices; where NumPy is there, vectors and matrices are its arrays.
"""

import json
import os
import random
import select
import struct
import sys
import threading
import time
import traceback
import types

try:
    import numpy
except ImportError:
    numpy = None

SETUP, RESET, STEP = 1, 2, 3
READY, STARTED, COMMAND, ERROR = 101, 102, 103, 104
HEADER = struct.Struct("<II")
INFINITY = float("inf")


def vector(values):
    return numpy.array(values, dtype=float) if numpy is not None else tuple(float(v) for v in values)


class Robot:
    """What does not change while the process lives.

    base: "fixed", "differential" or "omnidirectional"; joints: names, from base to tip; velocities: names of what a command
    consists of, those of the base first; lower, upper: of the joints (infinite where there is no limit); ready: a posture;
    velocity_limits: largest absolute velocities; control_period [s]; description: all of the robot file, its URDF's text in
    "urdf_text" (docs/reference/robots.md).
    """

    def __init__(self, setup):
        self.description = setup["robot"]
        self.name = self.description["name"]
        self.base = setup["base"]
        self.joints = tuple(setup["joints"])
        self.velocities = tuple(setup["velocities"])
        self.lower = vector([-INFINITY if v is None else v for v in setup["lower"]])
        self.upper = vector([INFINITY if v is None else v for v in setup["upper"]])
        self.ready = vector(setup["ready"])
        self.velocity_limits = vector(setup["velocity_limits"])
        self.control_period = setup["control_period"]


class Shape:
    """What does not change of an object: name, shape ("sphere", "box", "cylinder", "capsule", "convex"; `kind` is the same),
    size (radius; edge lengths; radius and length), and a convex one's vertices and triangles."""

    def __init__(self, shape):
        self.name = shape["name"]
        self.shape = self.kind = shape["shape"]
        self.size = vector(shape["size"])
        self.vertices = [vector(v) for v in shape["vertices"]]
        self.triangles = [tuple(t) for t in shape["triangles"]]


class Record:
    """Numbers of moma's by the names of their members: what is sensed at one step, or a part of it. It may be kept: no later
    step changes it. Where vectors are arrays, they are parts of the numbers."""

    __slots__ = ("_values", "_at", "_items")
    members = ()

    def __init__(self, values, at=0):
        self._values = values
        self._at = at
        self._items = None

    def __repr__(self):
        return "%s(%s)" % (type(self).__name__, ", ".join("%s=%r" % (m, getattr(self, m)) for m in self.members))


def reader(member):
    """Reads a member (docs/reference/process-protocol.md, "Layout") of a record."""
    at, count, shape = member["at"], member["count"], member.get("shape")
    end = at + count
    if "list" in member:
        item = record(member["name"].capitalize(), member["members"])

        def items(self):
            if self._items is None:
                self._items = [item(self._values, i) for i in range(self._at + at, len(self._values), count)]
            return self._items

        return items
    if "members" in member:
        part = record(member["name"].capitalize(), member["members"])
        return lambda self: part(self._values, self._at + at)
    if "words" in member:
        return lambda self: member["words"][int(self._values[self._at + at])]
    if not shape:
        kind = bool if "truth" in member else int if "whole" in member else float
        return lambda self: kind(self._values[self._at + at])
    if len(shape) == 1:
        return lambda self: self._values[self._at + at : self._at + end]

    def matrix(self):
        part = self._values[self._at + at : self._at + end]
        if numpy is not None:
            return part.reshape(shape)
        return tuple(part[i : i + shape[1]] for i in range(0, count, shape[1]))

    return matrix


def where_given(read, given):
    return lambda self: read(self) if self._values[self._at + given] != 0.0 else None


def record(name, members, base=Record):
    """A class with these members."""
    body = {"__slots__": (), "members": tuple(member["name"] for member in members)}
    for member in members:
        read = reader(member)
        body[member["name"]] = property(where_given(read, member["given"]) if "given" in member else read)
    return type(name, (base,), body)


def word(words, value, what):
    try:
        return float(words.index(value))
    except ValueError:
        raise ValueError("%s is %r, none of %s" % (what, value, ", ".join(words))) from None


class Answers:
    """Bytes of what step() returned: the numbers of a command, or what has them as its "command" and may have any of `details`
    (a layout) beside, by keys or as attributes."""

    def __init__(self, robot, details):
        self.names = robot.velocities
        self.size = len(self.names)
        self.details = details
        self.keys = ("command",) + tuple(member["name"] for member in details)
        self.otherwise = [INFINITY if v is None else v for member in details for v in member["otherwise"]]

    def numbers(self, command):
        if command is None:
            raise TypeError("step() returned nothing; the robot wants %s" % self.wanted())
        numbers = [float(v) for v in command]
        if len(numbers) != self.size:
            raise ValueError("step() returned %d numbers, the robot wants %s" % (len(numbers), self.wanted()))
        return numbers

    def wanted(self):
        return "%d: %s" % (self.size, ", ".join(self.names))

    def encode(self, answer):
        if numpy is not None and type(answer) is numpy.ndarray and answer.shape == (self.size,):
            return HEADER.pack(8 * self.size, COMMAND) + answer.astype("<f8", copy=False).tobytes()
        if hasattr(answer, "command"):
            answer = {key: getattr(answer, key) for key in self.keys if hasattr(answer, key)}
        if not isinstance(answer, dict):
            return self.frame(self.numbers(answer))
        for key in answer:
            if key not in self.keys:
                raise KeyError("step() returned the key %r, none of %s" % (key, ", ".join(self.keys)))
        details = list(self.otherwise)
        for member in self.details:
            if member["name"] in answer:
                at, count = member["at"], member["count"]
                details[at : at + count] = self.detail(member, answer[member["name"]])
        return self.frame(self.numbers(answer.get("command")) + details)

    def detail(self, member, value):
        if "words" in member:
            return [word(member["words"], value, member["name"])]
        numbers = [float(v) for v in (value if member["shape"] else (value,))]
        if len(numbers) != member["count"]:
            raise ValueError("%s has %d numbers instead of %d" % (member["name"], len(numbers), member["count"]))
        return numbers

    def frame(self, numbers):
        return struct.pack("<II%dd" % len(numbers), 8 * len(numbers), COMMAND, *numbers)


def told(error):
    """One line: the error, and after it the places that it came by, without those of this file."""
    text = "".join(traceback.format_exception_only(type(error), error)).strip()
    if isinstance(error, SyntaxError):
        return "SyntaxError: %s (%s:%s)" % (error.msg, os.path.basename(error.filename or "?"), error.lineno)
    places = []
    for frame in traceback.extract_tb(error.__traceback__):
        if frame.filename == "<string>":
            continue
        line = ": " + frame.line if frame.line else ""
        places.append("%s:%s in %s%s" % (os.path.basename(frame.filename), frame.lineno, frame.name, line))
    if len(places) > 12:
        places = places[:4] + ["..."] + places[-8:]
    cause = error.__cause__
    if cause is not None and cause is not error:
        text += "; from " + told(cause)
    return text + "".join(" | " + place for place in places)


class Line:
    """Frames of the protocol, on descriptors that the controller knows nothing of."""

    def __init__(self):
        self.source = os.dup(0)
        self.sink = os.dup(1)
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)
        os.dup2(2, 1)  # what the controller prints is no answer
        sys.stdout.reconfigure(line_buffering=True)
        threading.Thread(target=self.watch, daemon=True).start()

    def watch(self):
        """Ends a controller that still computes when moma is gone."""
        gone = select.poll()
        gone.register(self.source, 0)
        gone.poll()
        time.sleep(2.0)
        os._exit(1)

    def read(self, expected):
        """Kind and all bytes of a frame, header included; kind 0 at the end."""
        data = os.read(self.source, expected)
        while len(data) < HEADER.size:
            more = os.read(self.source, expected)
            if not more:
                return 0, b""
            data += more
        length, kind = HEADER.unpack_from(data)
        missing = HEADER.size + length - len(data)
        if missing > 0:
            parts = [data]
            while missing > 0:
                part = os.read(self.source, min(missing, 1 << 20))
                if not part:
                    return 0, b""
                parts.append(part)
                missing -= len(part)
            data = b"".join(parts)
        return kind, data

    def write(self, data):
        while data:
            data = data[os.write(self.sink, data) :]

    def say(self, kind, text=""):
        payload = text.encode("utf-8", "replace")
        self.write(HEADER.pack(len(payload), kind) + payload)


def load(path, name):
    """The class `name` of a file, which is read as it is now: no compiled file of it is looked at."""
    folder, file = os.path.split(path)
    sys.path.insert(0, folder)
    with open(path, "rb") as source:
        code = compile(source.read(), path, "exec")
    stem = os.path.splitext(file)[0]
    module = types.ModuleType(stem if stem not in sys.modules else "moma_controller_" + stem)
    module.__file__ = path
    sys.modules[module.__name__] = module
    exec(code, module.__dict__)
    found = getattr(module, name, None)
    if not callable(found):
        classes = [n for n, v in vars(module).items() if isinstance(v, type) and v.__module__ == module.__name__]
        raise AttributeError("%s has no class %s%s" % (file, name, "; it has " + ", ".join(classes) if classes else ""))
    for function in ("reset", "step"):
        if not callable(getattr(found, function, None)):
            raise AttributeError("class %s has no %s()" % (name, function))
    return found


def own_files(path):
    """The modules that were loaded from the controller's folder: they are part of it."""
    folder = os.path.join(os.path.dirname(path), "")
    files = {path}
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if not file or not file.startswith(folder) or not os.path.isfile(file):
            continue
        if "site-packages" in file[len(folder) :].split(os.sep):
            continue
        files.add(file)
    return sorted(files)


def seed():
    random.seed(0)
    if numpy is not None:
        numpy.random.seed(0)


def main(path, name):
    line = Line()
    robot = answers = layout = parameters = made = controller = observation = None
    expected = 1 << 16
    while True:
        kind, data = line.read(expected)
        if kind == 0:
            return
        try:
            if kind == STEP:
                if numpy is not None:
                    values = numpy.frombuffer(data, "<f8", -1, HEADER.size)
                else:
                    values = struct.unpack_from("<%dd" % ((len(data) - HEADER.size) // 8), data, HEADER.size)
                line.write(answers.encode(controller.step(observation(values))))
            elif kind == RESET:
                shapes = [Shape(shape) for shape in json.loads(data[HEADER.size :])]
                objects = layout[-1]
                expected = HEADER.size + 8 * (objects["at"] + objects["count"] * len(shapes))
                seed()
                controller = made(**parameters)
                controller.reset(robot, shapes)
                line.say(STARTED)
            elif kind == SETUP:
                setup = json.loads(data[HEADER.size :])
                robot = Robot(setup)
                answers = Answers(robot, setup["details"])
                layout = setup["observation"]
                observation = record("Observation", layout)
                parameters = setup["parameters"]
                if made is None:
                    seed()
                    made = load(path, name)
                seed()
                made(**parameters)  # what is wrong with the parameters shows here, not in the first trial
                line.say(READY, json.dumps({"protocol": setup["protocol"], "files": own_files(path)}))
            else:
                raise ValueError("a frame of unknown kind %d" % kind)
        except BaseException as error:  # SystemExit too: it ends the trial, and says where it was raised
            line.say(ERROR, told(error))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
