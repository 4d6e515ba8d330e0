"""ArduPilot's parameters of `seatrial new ardupilot`, against the vehicle that they are for."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial import Simulation
from seatrial.cli.making.templates import texts, write

from .test_assembly import parameters

THRUST = {
    # Speed controllers, and the time in which its speed is steady, s.
    "usv": (("port_esc", "starboard_esc"), 30.0),
    "auv": (("esc",), 30.0),
    "azimuth": (("port_esc", "starboard_esc"), 60.0),
    "ship": (("esc",), 240.0),
}


@pytest.fixture
def made(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Make a vehicle of the kind, with what ArduPilot needs, in the current folder."""
    monkeypatch.chdir(tmp_path)
    for kind in (request.param, f"ardupilot/{request.param}"):
        write(texts("boat", kind), "", [("", "")])
    return str(request.param)


@pytest.mark.slow
@pytest.mark.parametrize("made", THRUST, indirect=True)
def test_the_throttle_for_its_cruise_gives_that_speed(made: str) -> None:
    values, (escs, seconds) = parameters("boat"), THRUST[made]
    with Simulation("vehicles/boat") as boat:
        if made == "auv":
            boat.set("stern_planes.pulse", 1.42e-3)  # it stays at the surface
        for esc in escs:
            boat.set(f"{esc}.pulse", 1.5e-3 + 4e-6 * values["CRUISE_THROTTLE"])
        boat.run(seconds)
        assert boat.get("hull.velocity.u") == pytest.approx(values["CRUISE_SPEED"], rel=0.03)
