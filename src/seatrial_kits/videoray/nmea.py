"""NMEA 0183 sentences as VideoRay's topside exports them.

Source: VideoRay Cockpit 1.7, "settings export" of its manual: $VRDPT depth and offset of the
transducer; $VRHDG magnetic heading, deviation, variation; $VRMTW water temperature; $PVRND time,
depth, heading, pitch, roll. The order of the last one's fields is the manual's; decimals are ours.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from operator import xor


def sentence(body: str) -> str:
    """Return a sentence with its ``$``, checksum and end of line."""
    return f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n"


def sentences(
    seconds: float, readings: Mapping[str, float], depth_of: Callable[[float], float]
) -> bytes:
    """Return the sentences for readings by register; ``depth_of`` a pressure in mbar, m.

    ``seconds`` are those of the run, as hhmmss.ss. Angles in degrees, temperature in degrees C.
    """
    depth, heading = depth_of(readings["pressure"]), readings["heading"] % 360.0
    minutes, second = divmod(seconds, 60.0)
    hours, minute = divmod(int(minutes), 60)
    clock = f"{hours % 24:02}{minute:02}{second:05.2f}"
    bodies = (
        f"VRDPT,{depth:.1f},0.0",
        f"VRHDG,{heading:.1f},0.0,E,0.0,E",
        f"VRMTW,{readings['water_temperature']:.1f},C",
        f"PVRND,{clock},{depth:.1f},{heading:.1f},{readings['pitch']:.1f},{readings['roll']:.1f}",
    )
    return "".join(map(sentence, bodies)).encode("ascii")
