"""A point that heads where guidance wants at once, at the speed wanted, in a current."""

import math

from seatrial.control.guidance import Guidance
from tests.devices.running import started

AT_ONCE = {"armed": True, "acceleration": 1e9}


def guidance(position=(0.0, 0.0), depth=0.0, **settings):
    """Return a started `Guidance` that is armed and whose speed wanted does not lag."""
    place = [position[0], position[1], depth]
    return started(Guidance, **{**AT_ONCE, "position_n": place, "depth": depth, **settings})


def leg(start, end, number=1, **settings):
    """Return the inputs of a leg in the horizontal plane, or in three dimensions."""
    ends = {"leg_from": [*start, 0.0][:3], "leg_to": [*end, 0.0][:3]}
    return {"mode": "auto", "leg": number, **ends, **settings}


def drive(guided, seconds, current=(0.0, 0.0), each=None):
    """Move the point on, the heading of each instant held to the next; return rows of outputs.

    ``each(t)`` sees the component at every instant, before it is advanced.
    """
    period, begin = guided.period, guided.now
    north, east, down = guided.position_n
    rows = []
    for k in range(round(seconds / period)):
        heading = guided.get("heading_wanted")
        guided.set("heading", heading)
        speed = guided.get("speed_wanted")
        velocity = [
            speed * math.cos(heading) + current[0],
            speed * math.sin(heading) + current[1],
        ]
        if each:
            each(begin + k * period)
        rows.append((begin + k * period, north, east, heading, speed, guided.get("cross_track")))
        guided.advance(begin + k * period, period)
        north, east = north + period * velocity[0], east + period * velocity[1]
        guided.set("velocity_n", [*velocity, 0.0])
        guided.set("position_n", [north, east, down])
    return rows
