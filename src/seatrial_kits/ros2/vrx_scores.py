"""Scores of the tasks of VRX, as its scoring plugins compute them; positions here are in {n}.

Open Robotics, VRX for Gazebo Sim (https://github.com/osrf/vrx): StationkeepingScoringPlugin.cc,
WayfindingScoringPlugin.cc and NavigationScoringPlugin.cc of vrx_gz/src.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

Place = Sequence[float]
"""North and east, m; what follows is not used."""
_SHARE = 0.75
"""By which each metre of distance lessens the weight of the heading."""


class Score(Protocol):
    """What a task has of the vehicle's motion."""

    value: float
    done: bool

    @property
    def errors(self) -> list[float]:
        """Of the pose at each goal, now or the least so far; of gates their states."""

    def add(self, position: Place, heading: float) -> None:
        """Take in the pose of one instant."""


def pose_error(position: Place, heading: float, goal: Place, goal_heading: float) -> float:
    """Return d + 0.75^d |psi - psi_goal|: the distance in m, the angle in rad, 0 to pi."""
    distance = math.dist(position[:2], goal[:2])
    turn = abs(math.remainder(goal_heading - heading, math.tau))
    return distance + math.pow(_SHARE, distance) * turn


class StationKeeping:
    """Mean pose error at the first goal, of all instants."""

    def __init__(self, goals: Sequence[Place], headings: Sequence[float]) -> None:
        self.done = False
        self._goal, self._heading = goals[0], headings[0]
        self.value, self.errors = 0.0, [0.0]
        self._total, self._count = 0.0, 0

    def add(self, position: Place, heading: float) -> None:
        """Take in the pose of one instant."""
        self.errors = [pose_error(position, heading, self._goal, self._heading)]
        self._total += self.errors[0]
        self._count += 1
        self.value = self._total / self._count


class Wayfinding:
    """Mean, over the goals, of the least pose error so far; in any order."""

    def __init__(self, goals: Sequence[Place], headings: Sequence[float]) -> None:
        self.done = False
        self._goals = [*zip(goals, headings, strict=True)]
        self.value, self.errors = 0.0, [math.inf] * len(goals)

    def add(self, position: Place, heading: float) -> None:
        """Take in the pose of one instant."""
        now = [pose_error(position, heading, *goal) for goal in self._goals]
        self.errors = [*map(min, self.errors, now)]
        self.value = sum(self.errors) / len(self.errors)


OUTSIDE, BEFORE, AFTER, CROSSED, INVALID = range(5)
"""States of a gate."""


class Gates:
    """Points for gates that are crossed: 10 each, and 1 for one right after the one before it.

    Two marks are a gate, red and green. It is crossed from before to after it, between them, with
    red to starboard: that is the direction which the plugin computes, though its description
    calls red the left mark. Nothing counts until the first gate is crossed; a gate that is passed
    the other way is invalid, and one that was left out is lost. The last one ends the task, with
    1 more if it was crossed. Collisions cost 3 each there; marks have no bodies here.
    """

    points, bonus = 10.0, 1.0

    def __init__(self, marks: Sequence[Place]) -> None:
        self._gates = [*zip(marks[::2], marks[1::2], strict=True)]
        self.value, self.done = 0.0, False
        self._states = [OUTSIDE] * len(self._gates)
        self._last, self._last_crossed = -1, -math.inf

    @property
    def errors(self) -> list[float]:
        """The states of the gates."""
        return [*map(float, self._states)]

    @property
    def crossed(self) -> int:
        """Number of gates that were crossed."""
        return self._states.count(CROSSED)

    def add(self, position: Place, heading: float) -> None:
        """Take in the pose of one instant."""
        for i in range(self._last + 1, len(self._gates)):
            now, before = _side(position, *self._gates[i]), self._states[i]
            if i and self._states[0] != CROSSED:
                return
            if (before, now) == (BEFORE, AFTER):
                self._cross(i)
                return
            if i and (before, now) == (AFTER, BEFORE):
                self._states[i], self._last, self._last_crossed = INVALID, i, -math.inf
                self.done = i == len(self._gates) - 1
                return
            self._states[i] = now

    def _cross(self, i: int) -> None:
        self._states[i] = CROSSED
        self.value += self.points
        if i and i == self._last_crossed + 1:
            self.value += self.bonus
        self._last = self._last_crossed = i
        if i == len(self._gates) - 1:
            self.value += self.bonus
            self.done = True


def _side(position: Place, red: Place, green: Place) -> int:
    """Return where a position is from a gate: outside of its marks, before or after it."""
    north, east = (0.5 * (a + b) for a, b in zip(red[:2], green[:2], strict=True))
    width = math.dist(red[:2], green[:2])
    # From green to red is starboard, and ahead is a quarter of a turn to port of that.
    across = (red[0] - green[0]) / width, (red[1] - green[1]) / width
    ahead = across[1], -across[0]
    dn, de = position[0] - north, position[1] - east
    if abs(dn * across[0] + de * across[1]) > 0.5 * width:
        return OUTSIDE
    return AFTER if dn * ahead[0] + de * ahead[1] >= 0.0 else BEFORE
