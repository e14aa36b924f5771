"""moma's own controller behind a Python class: its trials are those of the program, bit for bit."""

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
