"""ArduPilot's parameters of `seatrial new ardupilot`, against the vehicle that they are for."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial import Simulation
from seatrial.cli.making.templates import texts, write

from .test_assembly import parameters

TWO = ("port_esc", "starboard_esc")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("like", "escs", "seconds"),
    [
        ("usv", TWO, 30.0),
        ("auv", ("esc",), 30.0),
        ("azimuth", TWO, 60.0),
        ("ship", ("esc",), 240.0),
    ],
)
def test_the_throttle_for_its_cruise_gives_that_speed(
    like: str,
    escs: tuple[str, ...],
    seconds: float,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    for kind in (like, f"ardupilot/{like}"):
        write(texts("boat", kind), "", [("", "")])
    values = parameters("boat")
    with Simulation("vehicles/boat") as boat:
        if like == "auv":
            boat.set("stern_planes.pulse", 1.42e-3)  # it stays at the surface
        for esc in escs:
            boat.set(f"{esc}.pulse", 1.5e-3 + 4e-6 * values["CRUISE_THROTTLE"])
        boat.run(seconds)
        assert boat.get("hull.velocity.u") == pytest.approx(values["CRUISE_SPEED"], rel=0.03)
