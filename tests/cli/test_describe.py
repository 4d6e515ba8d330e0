"""``seatrial describe``: every connection of a rig, and what is left open."""

from __future__ import annotations

import pytest

from tests.command import seatrial
from tests.kit import needs_kits


@pytest.mark.slow
@needs_kits("videoray")
def test_every_connection_is_shown_and_what_is_open(tmp_path) -> None:
    done = seatrial("describe", "sil", "--vehicle", "videoray", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = [line.split() for line in done.stdout.splitlines()]
    assert ["vehicle.hull.position", "->", "vehicle.depth.position"] in lines
    allocated = "autopilot.pilot.allocation.port"
    assert [allocated, "->", "vehicle.thrusters.port.command"] in lines
    count = next(int(line[0]) for line in lines if line[1:] == ["connections"])
    assert sum("->" in line for line in lines) == count
    assert '"vehicle.motion" = "autopilot.truth?": there is no autopilot.truth' in done.stdout
    assert ["vehicle.hull.current"] in lines
    assert ["hull:", "rov"] in lines


@pytest.mark.slow
@needs_kits("mavlink", "ships")
def test_a_trials_rig_is_described_with_its_choices(tmp_path) -> None:
    done = seatrial("describe", "mariner-mission", cwd=tmp_path)
    assert "vehicle = mariner" in done.stdout
    assert "autopilot.mavlink.tunable.t11" in done.stdout


def test_mistakes_have_near_misses(tmp_path) -> None:
    done = seatrial("describe", "sil", "--vehicle", "otetr", cwd=tmp_path)
    assert done.returncode == 2
    assert "did you mean 'vehicles/otter'" in done.stderr
    done = seatrial("describe", "sil", "--choose", "vessel=otter", cwd=tmp_path)
    assert "unknown choice 'vessel'" in done.stderr
    (tmp_path / "mine.toml").write_text(
        'rig = "sil"\nstop = "1 s"\nchoices = { vehicle = "hydrona" }\n'
    )
    done = seatrial("describe", "mine.toml", cwd=tmp_path)
    assert "did you mean 'vehicles/hydrone'" in done.stderr


@pytest.mark.slow
def test_a_part_of_a_rig_is_described_alone(tmp_path) -> None:
    done = seatrial("describe", "vehicles/otter", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert ["hull.rates", "->", "gnss.rates"] in [line.split() for line in done.stdout.splitlines()]
    done = seatrial("describe", "vehicles/oter", cwd=tmp_path)
    assert "did you mean 'vehicles/otter'" in done.stderr
