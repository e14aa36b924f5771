"""Drives a differential base so that a point ahead of it, where the hand is, comes to lie over the goal; the arm holds still.

A controller for `method: python` with nothing but the standard library (docs/how-to/python-controller.md). It knows no
obstacles and no heights: what it is good for is to be compared with one that does.
"""

import math


class HandOverGoal:
    def __init__(self, gain=1.0, ahead=0.5):
        self.gain = gain  # [1/s]
        self.ahead = ahead  # of the point, along the base's heading [m]

    def reset(self, robot, objects):
        if robot.base != "differential":
            raise ValueError("%s has a base of kind %s, this drives a differential one" % (robot.name, robot.base))
        self.command = [0.0] * len(robot.velocities)

    def step(self, seen):
        x, y, heading = seen.base
        forward, left = (math.cos(heading), math.sin(heading)), (-math.sin(heading), math.cos(heading))
        goal = seen.goal.position
        error = (goal[0] - x - self.ahead * forward[0], goal[1] - y - self.ahead * forward[1])
        # The point moves by v along the heading and by ahead * omega across it.
        command = list(self.command)
        command[0] = self.gain * (error[0] * forward[0] + error[1] * forward[1])
        command[1] = self.gain * (error[0] * left[0] + error[1] * left[1]) / self.ahead
        return command
