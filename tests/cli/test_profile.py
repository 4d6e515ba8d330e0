"""The profile command as its user meets it."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.system.files import available
from seatrial.system.profile.kinds import GROUPS, keys
from seatrial.system.profile.profile import load_profile
from tests.command import seatrial
from tests.cosim.test_profile import GOOD
from tests.kit import OF_PROFILES, needs_kits


@needs_kits(*OF_PROFILES)
@pytest.mark.parametrize("name", sorted(available("hil_profiles")))
def test_shipped_profiles_have_no_problem(name: str, tmp_path: Path) -> None:
    done = seatrial("profile", "check", name, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith(f"{name}.toml: no problem found\n")


@needs_kits("mavlink")
def test_mistakes_are_reported_with_file_and_key(write, tmp_path: Path) -> None:
    text = GOOD.replace("system_id = 7", "system_id = 256").replace('"2 cm"', '"-2 cm"')
    write("boat.toml", text)
    done = seatrial("profile", "check", "boat.toml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    first, second = done.stderr.splitlines()
    assert first.startswith("seatrial: ")
    assert "boat.toml: identity.system_id: " in first
    assert "boat.toml: sensors.gnss.position_n_noise: at least 0 m needed" in second


@pytest.mark.parametrize("command", ["check", "describe"])
def test_an_unknown_profile_has_near_misses(command: str, tmp_path: Path) -> None:
    done = seatrial("profile", command, "hydron", cwd=tmp_path)
    assert done.returncode == 2
    assert "did you mean 'hydrone'" in done.stderr


def rows(text: str, title: str) -> list[str]:
    """Return the lines of the section ``title``."""
    lines = text[text.index(f"\n{title}\n") + 1 :].splitlines()[1:]
    return lines[: lines.index("")] if "" in lines else lines


@needs_kits("mavlink")
def test_describe_shows_what_the_file_says_in_units_that_people_read(write, tmp_path: Path) -> None:
    write("boat.toml", GOOD.replace('"A boat"', '"A [red] boat"'))
    done = seatrial("profile", "describe", "boat.toml", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("A [red] boat\n")
    identity = [line.split()[:2] for line in rows(done.stdout, "identity")]
    assert ["autopilot_type", "px4"] in identity
    assert ["uid", "0xFFFFFFFFFFFFFFFF"] in identity
    home = [line.split() for line in rows(done.stdout, "home")]
    assert ["latitude", "-31.7800000", "deg"] in home
    assert ["altitude", "1.2", "m"] in home
    assert ["date", "2026-02-05"] in home
    actuators = [line.split() for line in rows(done.stdout, "actuators")]
    assert actuators[1:] == [
        *(["1", "port", "port_thruster.pulse", "1100", "1500", "1900", "no", "data", "sheet"],),
        *(["2", "rudder", "rudder.pulse", "1000", "1500", "2000", "yes", "data", "sheet"],),
    ]
    gnss = {
        line.split()[0]: " ".join(line.split()[1:])
        for line in rows(done.stdout, "sensors.gnss: gnss")
    }
    assert gnss["source:"] == "data sheet"
    assert gnss["antenna"].startswith("(0.1, 0, -0.3) m profile ")
    assert gnss["position_n_noise"].startswith("0.02 m profile ")
    assert gnss["delay"].startswith("0.15 s default ")
    heading = rows(done.stdout, "sensors.heading: compass")
    assert any(line.split()[:4] == ["heading_noise", "0.5", "deg", "profile"] for line in heading)


@needs_kits(*OF_PROFILES)
@pytest.mark.parametrize("name", sorted(available("hil_profiles")))
def test_describe_shows_every_parameter_of_every_table(name: str, tmp_path: Path) -> None:
    done = seatrial("profile", "describe", name, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    profile = load_profile(name)
    for group in GROUPS:
        for table, entry in profile.tables(group).items():
            kind = entry["kind"]
            shown = rows(done.stdout, f"{group}.{table}: {kind}")
            first = 2 if shown[0].startswith("  source") else 1
            assert [line.split()[0] for line in shown[first:]] == list(keys(group, kind))


@needs_kits(*OF_PROFILES, "ships")
def test_describe_shows_what_a_ground_station_tunes(tmp_path: Path) -> None:
    done = seatrial("profile", "describe", "mariner", cwd=tmp_path)
    shown = [line.split() for line in rows(done.stdout, "tunables of links.ground")]
    assert shown[-1] == [
        *("RUDDER_MAX", "1", "35", "deg", "autopilot.rudder_limit", "helm.rudder_limit"),
    ]
    link = [line.split() for line in rows(done.stdout, "links.ground: mavlink")]
    assert ["tunables", "11,", "below", "profile"] in [words[:4] for words in link]


@needs_kits(*OF_PROFILES)
def test_describe_shows_which_sensor_reaches_a_firmware(tmp_path: Path) -> None:
    done = seatrial("profile", "describe", "bluerov2", cwd=tmp_path)
    rows = [line.split() for line in done.stdout.splitlines()]
    # Uniform noise of a standard deviation of 2 mm; a fix every 0.2 s.
    assert ["SIM_BARO_RND", "0.003464", "sensors.depth.depth_noise"] in rows
    assert ["SIM_GPS1_HZ", "5", "sensors.positioning.period"] in rows
