"""Contact of a craft with a scene, against closed forms; the craft here are points and spheres."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from seatrial.contact import restitution
from seatrial.craft.kinematics import to_body, to_ned
from seatrial.environment.contact import Contact
from seatrial.errors import InputError

G, MASS, H = 9.81, 20.0, 0.01


def contact(**values: Any) -> Contact:
    component = Contact("contact")
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    return component


class Ball:
    """A mass without rotation whose contact is held for each step, as a master does it."""

    def __init__(self, place: Any, velocity: Any, weight: Any = (0.0, 0.0, MASS * G), **of: Any):
        self.component = contact(**of)
        self.place, self.velocity = np.array(place, float), np.array(velocity, float)
        self.weight, self.time = np.array(weight, float), 0.0

    def forces(self) -> np.ndarray:
        component = self.component
        component.position, component.velocity = tuple(self.place), tuple(self.velocity)
        component.attitude, component.rates = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        component.outputs(self.time)
        return np.array(component.force)

    def run(self, duration: float, each: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(duration / H)):
            pull = (self.forces() + self.weight) / MASS
            self.component.step(self.time, H)
            self.place += self.velocity * H + pull * H * H / 2
            self.velocity += pull * H
            self.time += H
            each()


def test_it_rests_where_its_weight_is_carried() -> None:
    """delta = m g / k on one point, to 1e-9 of a metre."""
    ball = Ball((0, 0, 9.9), (0, 0, 0), seabed_depth=10.0, stiffness=4000.0, damping=5.0)
    ball.run(20.0)
    ball.forces()
    assert ball.component.penetration == pytest.approx(MASS * G / 4000.0, abs=1e-9)
    assert ball.component.normal_force == pytest.approx(MASS * G, rel=1e-6)
    assert ball.component.touching


@pytest.mark.parametrize("damping", [0.0, 1.0, 4.0])
def test_it_bounces_with_the_restitution_of_the_law(damping: float) -> None:
    """Without weight, at 0.5 m/s: e of Hunt and Crossley, and never more energy than before."""
    of = {"seabed_depth": 10.0, "stiffness": 2000.0, "damping": damping, "radius": 0.2}
    ball = Ball((0, 0, 9.7), (0, 0, 0.5), (0, 0, 0), **of)
    ball.run(1.5)
    expected = 0.5 * restitution(damping, 0.5)
    assert -ball.velocity[2] == pytest.approx(expected, rel=0.02)
    assert ball.component.touches == 1
    assert not ball.component.touching


def test_friction_stops_it_as_coulomb_has_it() -> None:
    """From 1 m/s at mu 0.3 within v^2 / (2 mu g), lengthened by the speed at which it fades."""
    delta = MASS * G / 4000.0
    of = {"seabed_depth": 10.0, "stiffness": 4000.0, "friction_coefficient": 0.3}
    ball = Ball((0, 0, 10.0 + delta), (1.0, 0, 0), **of)
    ball.run(1.0)
    assert ball.place[0] == pytest.approx(1.0 / (2 * 0.3 * G), rel=0.04)
    assert ball.place[0] > 1.0 / (2 * 0.3 * G)
    assert abs(ball.velocity[0]) < 1e-3


@pytest.mark.parametrize(("mu", "slides"), [(0.3, True), (0.7, False)])
def test_it_slides_where_the_slope_is_steeper_than_mu(mu: float, slides: bool) -> None:
    """On 30 degrees, tan 0.577: it gathers speed by g (sin - mu cos), or creeps."""
    slope = math.radians(30.0)
    of = {"seabed_depth": 10.0, "seabed_slope": slope, "stiffness": 4000.0, "damping": 5.0}
    delta = MASS * G * math.cos(slope) / 4000.0
    ball = Ball((0, 0, 10.0 + delta / math.cos(slope)), (0, 0, 0), friction_coefficient=mu, **of)
    ball.run(2.0)
    speed = math.hypot(*ball.velocity)
    if slides:
        pull = G * (math.sin(slope) - mu * math.cos(slope))
        assert speed == pytest.approx(2.0 * pull, rel=0.02)
    else:
        r = math.tan(slope) / mu
        assert speed == pytest.approx(0.02 * r / math.sqrt(1 - r * r), rel=0.01)


def test_force_and_moment_are_those_of_the_place_of_contact() -> None:
    """Work of force and moment on any motion of the craft is that of F at the contact."""
    component = contact(
        seabed_depth=5.0, obstacles="box 3 0 3 2 8 8 20", count=2.0, radius=0.3,
        point_1=[0.9, 0.2, 0.4], point_2=[-0.5, 0.1, 0.6], stiffness=1500.0,
    )  # fmt: skip
    attitude = (0.3, -0.2, 0.5)
    component.position, component.attitude = (1.05, 0.3, 4.4), attitude
    component.velocity, component.rates = (0.4, -0.1, 0.3), (0.1, 0.2, -0.3)
    component.outputs(0.0)
    power = np.dot(component.force, component.velocity) + np.dot(component.moment, component.rates)
    total, by_hand = np.zeros(3), 0.0
    for r in component.points():
        place = np.array(component.position) + to_ned(attitude, r)
        face = component.scene().nearest(place)
        delta, normal = 0.3 - face.distance, np.array(face.normal)
        if delta <= 0.0:
            continue
        arm = np.array(r) - face.distance * np.array(to_body(attitude, tuple(normal)))
        v = np.array(to_ned(attitude, np.cross(component.rates, arm) + component.velocity))
        push = 1500.0 * delta * max(0.0, 1.0 - v @ normal)
        along = v - (v @ normal) * normal
        force = push * normal - 0.4 * push * along / math.hypot(*along, 0.02)
        total += force
        by_hand += force @ v
    assert by_hand != 0.0
    assert to_ned(attitude, component.force) == pytest.approx(total)
    assert power == pytest.approx(by_hand)


def test_what_is_far_from_everything_is_left_alone() -> None:
    for scene in ({"seabed_depth": 10.0}, {}):
        ball = Ball((0, 0, 2.0), (0, 0, 1.0), (0, 0, 0), **scene)
        ball.run(1.0)
        assert tuple(ball.velocity) == (0.0, 0.0, 1.0)
        assert ball.component.touches == 0


def test_a_part_of_a_point_is_refused() -> None:
    with pytest.raises(InputError, match=r"contact.count is 1.5, a whole number is needed"):
        contact(count=1.5)
