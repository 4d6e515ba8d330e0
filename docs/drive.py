"""The picture of `seatrial drive` in its page: ``python docs/drive.py`` draws it anew."""

from __future__ import annotations

import io
import math

from drawing import draw
from rich.console import Console

from seatrial.model.component import Component
from seatrial_kits.videoray.driving.pilot import Pilot
from seatrial_kits.videoray.driving.screen import picture
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.topside import Pro4Topside

STEP = 0.01
MANUAL_AXES = (0.3, -0.2, 0.0)


def main() -> None:
    """Run both ends for two seconds of simulated time, and draw what the pilot sees."""
    rov, topside = Pro4Rov("rov"), Pro4Topside("topside")
    ends: tuple[Component, ...] = (rov, topside)
    for end in ends:
        end.setup(0.0)
        end.initialise()
        end.begin()
    rov.set("attitude", [math.radians(6.0), math.radians(-4.0), math.radians(312.0)])
    rov.set("depth", 12.4)
    for number in range(200):
        said, received = topside.get("tx"), rov.get("tx")
        rov.set("rx", said)
        topside.set("rx", received)
        for end in ends:
            end.advance(number * STEP, STEP)
    pilot = Pilot(armed=True, lights=0.6, camera_tilt=math.radians(-20.0))
    pilot.hold_heading, pilot.heading_wanted = True, math.radians(325.0)
    pilot.hold_depth, pilot.depth_wanted = True, 12.5
    console = Console(width=80, record=True, force_terminal=True, file=io.StringIO())
    console.print(picture(topside, pilot, MANUAL_AXES))
    draw(console, "drive", "seatrial drive")


if __name__ == "__main__":
    main()
