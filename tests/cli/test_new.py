"""seatrial new vehicle: the files run as they are."""

import math
import tomllib

import pytest

from seatrial import Simulation
from seatrial.cli.new import KINDS
from tests.command import seatrial
from tests.kits.arduino.bench import need

NAME = "my-boat_2"
WRITTEN = {
    "usv": {
        f"vehicles/{NAME}.toml",
        f"harness/rigs/vehicles/{NAME}.toml",
        f"harness/rigs/pilots/{NAME}.toml",
        f"harness/trials/{NAME}.toml",
        f"harness/trials/{NAME}-mission.toml",
        f"harness/trials/{NAME}-sketch.toml",
        f"harness/firmware/{NAME}/{NAME}.ino",
        f"harness/rigs/ardupilot/{NAME}.toml",
        f"hil_profiles/{NAME}.parm",
        f"hil_profiles/{NAME}.toml",
    },
    "rov": {
        f"vehicles/{NAME}.toml",
        f"harness/rigs/vehicles/{NAME}.toml",
        f"harness/rigs/pilots/{NAME}.toml",
        f"harness/trials/{NAME}.toml",
        f"harness/trials/{NAME}-mission.toml",
        f"harness/rigs/ardupilot/{NAME}.toml",
        f"hil_profiles/{NAME}.parm",
        f"hil_profiles/{NAME}.toml",
    },
}
every_kind = pytest.mark.parametrize("like", KINDS)


def new(folder, like="usv", name=NAME):
    return seatrial("new", "vehicle", name, "--like", like, cwd=folder)


def files(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def run(folder, *arguments):
    return seatrial("run", *arguments, "--engine", "direct", "--out", "out", cwd=folder)


@pytest.fixture
def made(tmp_path, request):
    """Return a folder with the files of a vehicle."""
    done = new(tmp_path, getattr(request, "param", "usv"))
    assert done.returncode == 0, done.stderr
    return tmp_path


every_made = pytest.mark.parametrize("made", KINDS, indirect=True)


@every_kind
def test_it_writes_the_files_and_says_what_next(like, tmp_path):
    done = new(tmp_path, like)
    assert done.returncode == 0, done.stderr
    written = files(tmp_path)
    assert written.keys() == WRITTEN[like]
    for path, data in written.items():
        assert f"\n  {path}\n" in done.stdout
        assert b"@" not in data
    for command in (f"run {NAME}", f"describe sil --vehicle {NAME}", f"run {NAME}-mission"):
        assert f"  seatrial {command} " in done.stdout


@every_made
def test_every_number_is_marked_as_invented(made):
    vehicle = tomllib.loads((made / f"vehicles/{NAME}.toml").read_text("utf-8"))
    tables = [value for value in vehicle.values() if isinstance(value, dict)]
    entries = [e for t in tables for e in t.values() if isinstance(e, dict)]
    parts = vehicle["propulsion"]["thrusters"]
    assert all(e["mark"] == "assumed" and "invented" in e["source"] for e in [*entries, *parts])
    profile = tomllib.loads((made / f"hil_profiles/{NAME}.toml").read_text("utf-8"))
    sections = [*profile["actuators"].values(), *profile["sensors"].values(), profile["home"]]
    assert all("invented" in s["source"] or "no sensor" in s["source"] for s in sections)


@every_made
def test_profile_and_rig_are_sound(made):
    done = seatrial("profile", "check", NAME, cwd=made)
    assert (done.returncode, done.stdout.count("note:")) == (0, 0), done.stderr
    done = seatrial("describe", NAME, cwd=made)
    assert done.returncode == 0, done.stderr
    assert "vehicle.propulsion.force" in done.stdout
    assert NAME in seatrial("list", cwd=made).stdout


@pytest.mark.interop
@every_made
def test_describe_under_every_autopilot(made):
    for autopilot in ("guidance", "mavlink"):
        arguments = ("sil", "--vehicle", NAME, "--autopilot", autopilot)
        done = seatrial("describe", *arguments, cwd=made)
        assert done.returncode == 0, done.stderr


@every_made
def test_it_runs_under_guidance(made):
    done = run(made, NAME, "--set", "stop=5 s")
    assert done.returncode == 1, done.stderr  # no waypoint is passed yet
    assert "FAIL  all waypoints are passed" in done.stdout
    assert done.stdout.count("PASS") >= 2


def test_a_trial_of_another_autopilot_is_refused_with_the_rig_that_lacks_the_course(made):
    done = run(made, NAME, "--autopilot", "mavlink")
    assert done.returncode == 2
    assert "set: unknown component 'course'; (known: mavlink, pilot)" in done.stderr
    assert "in autopilot, the rig mavlink\n" in done.stderr


@pytest.mark.long
@every_made
def test_its_trial_passes(made):
    done = run(made, NAME)
    assert done.returncode == 0, done.stdout


@every_made
def test_it_runs_for_ground_stations(made):
    links = ("--set", "autopilot.mavlink.links=")
    done = run(made, f"{NAME}-mission", *links, "--set", "stop=5 s", "--real-time", "1e6")
    assert done.returncode == 0, done.stderr


def test_its_sketch_turns_it_east(made):
    need("host")
    done = run(made, f"{NAME}-sketch", "--set", "stop=21 s")
    assert done.returncode == 0, done.stdout + done.stderr
    checked = seatrial(
        "sketch", "check", f"harness/firmware/{NAME}", "--profile", f"{NAME}:mega", cwd=made
    )
    assert "nothing is unsupported" in checked.stdout


@pytest.mark.parametrize("made", ["rov"], indirect=True)
def test_eight_thrusters_drive_it_as_manual_control_says(made, monkeypatch):
    monkeypatch.chdir(made)
    pilot, hull = "autopilot.pilot", "vehicle.hull"
    settings = {f"{pilot}.guidance.mode": "manual", f"{hull}.eta_start.z": 3.0}
    for axis, moved in (("surge", "u"), ("sway", "v"), ("heave", "w")):
        given = {**settings, f"{pilot}.guidance.manual.{axis}": 0.3}
        with Simulation("sil", choices={"vehicle": NAME}, set=given) as simulation:
            simulation.run("2 s")
            speeds = {a: simulation.get(f"{hull}.velocity.{a}") for a in "uvw"}
            assert abs(simulation.get(f"{hull}.attitude.theta")) < math.radians(3.0)
        assert speeds.pop(moved) > 0.1
        assert max(map(abs, speeds.values())) < 0.03


@every_made
def test_under_guidance_its_profile_needs_actuators_and_sensors_only(made):
    path = made / f"hil_profiles/{NAME}.toml"
    text = path.read_text("utf-8")
    cut = text[text.index("[actuators.") : text.index("[links.")]
    lines = [line for line in cut.splitlines() if not line.startswith("source")]
    path.write_text("\n".join(['title = "bare"', *lines]), "utf-8")
    done = run(made, NAME, "--set", "stop=1 s")
    assert done.returncode == 1, done.stderr
    assert f"note: profile {NAME}: actuators." in done.stdout
    done = run(made, f"{NAME}-mission", "--set", "stop=1 s")
    assert "unknown section 'links.ground'" in done.stderr


def test_what_a_link_takes_by_default_is_a_note(made):
    path = made / f"hil_profiles/{NAME}.toml"
    text = path.read_text("utf-8")
    path.write_text(text[: text.index("[identity]")] + text[text.index("[actuators.") :], "utf-8")
    links = ("--set", "autopilot.mavlink.links=")
    done = run(made, f"{NAME}-mission", *links, "--set", "stop=1 s", "--real-time", "1e6")
    assert done.returncode == 0, done.stderr
    note = f"note: profile {NAME}: links.ground has defaults for what [identity] and [home] do not"
    assert note in done.stdout
    assert note in seatrial("profile", "check", NAME, cwd=made).stdout


def test_a_second_call_writes_nothing(made):
    (made / f"vehicles/{NAME}.toml").write_text("mine", "utf-8")
    (made / f"hil_profiles/{NAME}.toml").unlink()
    before = files(made)
    done = new(made)
    assert done.returncode == 2
    assert f"nothing is written, for there is already harness/firmware/{NAME}/" in done.stderr
    assert files(made) == before


def test_a_file_in_the_place_of_a_folder_is_refused(tmp_path):
    (tmp_path / "vehicles").write_text("mine", "utf-8")
    done = new(tmp_path)
    assert done.returncode == 2
    assert "there is already vehicles\n" in done.stderr
    assert files(tmp_path) == {"vehicles": b"mine"}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        *((bad, f"NAME {bad!r}: letters") for bad in ("a b", "../x", "a.b", "é", "con", "LPT1")),
        ("", "NAME '': letters"),
        ("x" * 41, "40 at most"),
        ("{vehicle}", "NAME '{vehicle}': letters"),
        ("hydrone", "seatrial ships harness/rigs/ardupilot/hydrone.toml, "),
        ("fleet", "seatrial ships harness/trials/fleet.toml, which yours would hide"),
    ],
)
def test_names_that_cannot_be(name, expected, tmp_path):
    done = new(tmp_path, name=name)
    assert done.returncode == 2
    assert expected in done.stderr
    assert files(tmp_path) == {}


def test_kinds_that_are_none(tmp_path):
    done = new(tmp_path, "uvs")
    assert done.returncode == 2
    assert "--like: unknown kind of vehicle 'uvs'; did you mean 'usv'?" in done.stderr
