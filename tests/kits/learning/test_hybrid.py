"""A model with a learned force beside its drone: it keeps to it, and C has the same bytes."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import seatrial
from seatrial.system.system import Engine
from tests.kit import needs_kits

pytestmark = [
    needs_kits("drone", "native"),
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]
SIGNALS = ("hybrid.position", "hybrid.velocity_n", "learned.force", "drone.body.velocity_n")


def flown(engine: Engine, duration: float) -> dict[str, list[float]]:
    start = [0.0, 0.0, -2.45]
    bodies = ("drone.body", "published", "hybrid")
    with seatrial.Simulation(
        "drone-models",
        set={f"{body}.position_start": start for body in bodies}
        | {"drone.landing.waypoint": [-3.0, -2.0]},
        seed=7,
        engine=engine,
    ) as simulation:
        simulation.run(duration)
        return {
            name: np.ravel(simulation.get(name)).tolist()
            for name in (*SIGNALS, "published.velocity_n")
        }


def test_c_has_the_same_bytes() -> None:
    assert flown("native", 0.05) == flown("direct", 0.05)


def test_its_velocity_after_2_s_errs_by_a_fifth_at_most() -> None:
    found = {name: np.array(values) for name, values in flown("native", 2.0).items()}
    drone = found["drone.body.velocity_n"]
    without = np.linalg.norm(found["published.velocity_n"] - drone)
    assert np.linalg.norm(found["hybrid.velocity_n"] - drone) < 0.2 * without


def test_the_shipped_trial_holds(tmp_path: Path) -> None:
    result = seatrial.run_trial("drone-hybrid", engine="native", out=tmp_path / "run")
    assert result.passed
