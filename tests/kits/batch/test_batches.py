"""Batches of different systems as one: the bytes of each alone, and clear mistakes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from seatrial import Batch, Batches, InputError

from .test_batch import PARTS, RIG

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

OTHER = f"""
step = "10 ms"
[components]
walker = {{ fmu = "{PARTS}:Walker", set = {{ period = "50 ms" }} }}
cork   = {{ fmu = "{PARTS}:Cork", set = {{ form = "square" }} }}
pilot  = {{ fmu = "{PARTS}:Pilot" }}
[connections]
"cork.x"      = "pilot.place"
"cork.v"      = "pilot.speed"
"pilot.force" = "cork.push"
"""
NAMES = ("cork.x", "cork.v", "cork.nu_r", "pilot.force")


@pytest.fixture(scope="module")
def rigs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("rigs")
    for name, text in (("cork.toml", RIG), ("other.toml", OTHER)):
        (folder / name).write_text(text, "utf-8")
    return folder / "cork.toml", folder / "other.toml"


@pytest.fixture
def batches(rigs: tuple[Path, Path]) -> Iterator[Batches]:
    with Batches([Batch(rigs[0], 2, seed=5), Batch(rigs[1], 3, seed=8, threads=2)]) as both:
        yield both


def test_each_system_has_the_bytes_that_it_has_alone(
    rigs: tuple[Path, Path], batches: Batches
) -> None:
    wanted = np.array([0.5, -0.5, 1.0, 2.0, -1.0])
    mask = np.array([True, False, True, False, True])
    masses = np.linspace(1.0, 3.0, 5)
    batches.step(7)
    batches.set("pilot.wanted", wanted)
    batches.override("pilot.force", "0.3 N", mask)
    batches.step(20)
    batches.release("pilot.force", mask)
    recorded = batches.record(4, *NAMES)
    batches.reset(mask, set={"cork.mass": masses, "pilot.gain": 3.0}, seed=30)
    batches.step(9, mask)
    found = batches.get(*NAMES)
    for rig, rows, seed in ((rigs[0], slice(0, 2), 5), (rigs[1], slice(2, 5), 8)):
        count, own = rows.stop - rows.start, mask[rows]
        with Batch(rig, count, seed=seed) as alone:
            alone.step(7)
            alone.set("pilot.wanted", wanted[rows])
            alone.override("pilot.force", 0.3, own)
            alone.step(20)
            alone.release("pilot.force", own)
            assert alone.record(4, *NAMES).tobytes() == recorded[rows].tobytes()
            alone.reset(
                own, set={"cork.mass": masses[rows], "pilot.gain": 3.0}, seed=30 + rows.start
            )
            alone.step(9, own)
            assert alone.get(*NAMES).tobytes() == found[rows].tobytes()
    assert np.array_equal(batches.time, np.where(mask, 9, 31) * 0.01)
    assert batches.seeds.tolist() == [30, 6, 32, 9, 34]
    assert batches.settings(4) == {"seed": 34, "cork.mass": 3.0, "pilot.gain": 3.0}
    assert batches.of.tolist() == [0, 0, 1, 1, 1]
    assert len(batches) == 5


def test_a_copy_that_fails_has_its_number_among_all(batches: Batches) -> None:
    batches.reset(set={"pilot.reach": np.array([1e9, 1e9, 1e9, 0.1, 1e9])})
    batches.set("pilot.wanted", 1.0)
    batches.step(5)
    assert list(batches.failures) == [3]
    assert "pilot" in batches.failures[3]
    assert batches.get("cork.x").shape == (5,)


def test_what_does_not_fit_is_named(rigs: tuple[Path, Path], batches: Batches) -> None:
    with pytest.raises(InputError, match="at least one"):
        Batches([])
    why = r"a step of 0\.02 s.* one of 0\.01 s; give Batch"
    with Batch(rigs[0], 1, step="20 ms") as slow, pytest.raises(InputError, match=why):
        Batches([batches.batches[0], slow])
    with pytest.raises(InputError, match="log"):
        batches.get("log.water_velocity.u")
    with pytest.raises(InputError, match="log"):
        batches.record(3, "log.water_velocity.u")
    assert not batches.time.any()
    with pytest.raises(InputError, match="mask"):
        batches.step(1, np.array([True, False]))
    with pytest.raises(InputError, match="allowed 0 to 4"):
        batches.settings(5)
    with pytest.raises(InputError, match="shape"):
        batches.set("pilot.wanted", np.zeros(4))
