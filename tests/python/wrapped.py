"""moma's own controller behind a Python class: its trials are those of the program, bit for bit."""

import os
import signal
import time

import moma


class Wrapped:
    def __init__(self, file):
        self.file = file

    def reset(self, robot, objects):
        self.controller = moma.Controller(moma.Robot(robot.description), self.file, robot.control_period)
        self.controller.reset(objects)

    def step(self, seen):
        return self.controller.step(seen)


class Failing:
    def reset(self, robot, objects):
        pass

    def step(self, seen):
        raise RuntimeError("not today")


class Slow:
    def reset(self, robot, objects):
        self.still = [0.0] * len(robot.velocities)

    def step(self, seen):
        time.sleep(0.05)
        return self.still


class Wrong:
    """At its third step."""

    def __init__(self, way):
        self.way = way

    def reset(self, robot, objects):
        self.still, self.steps = [0.0] * len(robot.velocities), 0

    def step(self, seen):
        self.steps += 1
        if self.steps == 3:
            getattr(self, self.way)()
        return self.still

    def raises(self):
        raise RuntimeError("not today")

    def exits(self):
        raise SystemExit(3)

    def dies(self):
        os.kill(os.getpid(), signal.SIGKILL)

    def hangs(self):
        while True:
            pass

    def hoards(self):
        self.much = bytearray(10_000_000_000)

    def prints(self):
        print("hello")
        os.write(1, b"hello")


class Gain:
    """Resolved rate with a gain."""

    def __init__(self, gain=1.0):
        self.gain = gain

    def reset(self, robot, objects):
        self.robot = moma.Robot(robot.description)
        self.controller = moma.Controller(self.robot, {"method": "rrmc"}, robot.control_period)
        self.controller.reset(objects)

    def step(self, seen):
        return self.gain * self.controller.step(seen).command
