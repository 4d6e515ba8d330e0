"""Craft whose parts are allocated, and the wrench that their orders and angles give."""

import math

import numpy as np

from seatrial_kits.fitted.allocation.part_allocation import PartAllocation
from tests.devices.running import started

ENDLESS = [-1e9, 1e9]
SIX = "surge sway heave roll pitch yaw"
PROPULSOR = {"position": [0, 0, 0], "axis": [1, 0, 0], "thrust": [1, 1], "exponent": 1.0}


def slots(propulsors=(), foils=(), **others):
    """Return parameters of parts: each propulsor and foil a kind and its own parameters."""
    values = {
        "propulsors": " ".join(kind for kind, _ in propulsors),
        "foils": " ".join(kind for kind, _ in foils),
    }
    for sort, parts in (("propulsor", propulsors), ("foil", foils)):
        for number, (_, own) in enumerate(parts, 1):
            values |= {f"{sort}_{name}_{number}": value for name, value in own.items()}
    return {**values, **others}


OSV = slots(
    [
        *[
            ("azimuth", {"position": [-35, y, 0], "thrust": [5e5, 2e5], "angle_limit": ENDLESS})
            for y in (-5, 5)
        ],
        *[
            ("tunnel", {"position": [x, 0, 0], "axis": [0, 1, 0], "thrust": [2e5, 2e5]})
            for x in (25, 30)
        ],
    ],
    axes="surge sway yaw",
)
"""An offshore supply ship: azimuths aft, tunnels forward."""

WAMV = slots(
    [
        ("outboard", {"position": [-2.4, y, 0], "thrust": [250, 100], "angle_limit": [-0.7, 0.7]})
        for y in (-1.0, 1.0)
    ],
    axes="surge yaw",
)
"""A catamaran with two outboards."""

COS = math.sqrt(0.5)
ROV = slots(
    [
        *[
            ("thruster", {"position": [x, y, 0.085], "axis": [a, b, 0], "thrust": [51.4, 39.9]})
            for x, y, a, b in (
                (0.156, 0.111, COS, -COS),
                (0.156, -0.111, COS, COS),
                (-0.156, 0.111, -COS, -COS),
                (-0.156, -0.111, -COS, COS),
            )
        ],
        *[
            ("thruster", {"position": [x, y, 0], "axis": [0, 0, -1], "thrust": [51.4, 39.9]})
            for x, y in ((0.12, 0.218), (0.12, -0.218), (-0.12, 0.218), (-0.12, -0.218))
        ],
    ],
    axes=SIX,
)
"""Four thrusters at 45 degrees below the CG, four vertical ones."""


def finned(rolls_deg, axes, **others):
    """Return a torpedo with a propeller and fins about its stern at these rolls."""
    fins = [
        (
            "fin",
            {
                "position": [-0.7, 0.08 * math.sin(roll), -0.08 * math.cos(roll)],
                "roll": roll,
                "area": 0.006,
                "aspect_ratio": 3.0,
                "angle_limit": 0.4,
            },
        )
        for roll in map(math.radians, rolls_deg)
    ]
    propeller = ("propeller", {"position": [-0.8, 0, 0], "thrust": [15, 8]})
    return slots([propeller], fins, axes=axes, **others)


def thrust(order, ahead, astern, exponent):
    side = ahead if order > 0 else astern
    return math.copysign(abs(order) ** exponent * side, order)


def wrench(allocation):
    """Return force and moment of the parts at what is ordered: the laws, written once more."""
    total = np.zeros(6)
    orders, angles = allocation.get("propulsor_order"), allocation.get("propulsor_angle")
    for number, kind in enumerate(allocation.get("propulsors").split(), 1):
        own = {name: allocation.get(f"propulsor_{name}_{number}") for name in PROPULSOR}
        x, y, z = own["axis"]
        c, s = math.cos(angles[number - 1]), math.sin(angles[number - 1])
        exponent = 2.0 if kind == "propeller" else own["exponent"]
        size = thrust(orders[number - 1], *own["thrust"], exponent)
        force = size * np.array([c * x - s * y, s * x + c * y, z])
        total += [*force, *np.cross(own["position"], force)]
    pressure = 0.5 * allocation.get("density") * allocation.get("speed") ** 2
    for number in range(1, len(allocation.get("foils").split()) + 1):
        roll, position, area, aspect = (
            allocation.get(f"foil_{n}_{number}")
            for n in ("roll", "position", "area", "aspect_ratio")
        )
        slope = 0.9 * math.tau * aspect / (math.sqrt(aspect**2 + 4) + 1.8)
        size = pressure * area * slope * allocation.get("foil_angle")[number - 1]
        # A positive angle turns the leading edge about the span, right-handed: lift on its side.
        force = -size * np.array([0.0, math.cos(roll), math.sin(roll)])
        total += [*force, *np.cross(position, force)]
    return total


def allocated(craft, **demand):
    """Return an allocation at a demand."""
    return started(PartAllocation, **craft, **demand)


def given(craft, **demand):
    """Return the wrench that parts give at a demand."""
    return wrench(allocated(craft, **demand))


def later(craft, seconds, **demand):
    """Return an allocation that has had the demand for some time."""
    allocation = allocated(craft, **demand)
    for k in range(round(seconds / 0.05)):
        allocation.advance(0.05 * k, 0.05)
    return allocation
