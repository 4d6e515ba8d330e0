"""seatrial new: the files run as they are."""

import csv
import math
import tomllib

import pytest

from seatrial import Simulation
from seatrial.cli.making.new import KINDS
from seatrial.cli.making.templates import texts, write
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.profile.profile import check_profile, load_profile
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from tests.command import seatrial
from tests.kit import needs_kits

pytestmark = needs_kits("fitted")
NAME = "my-boat_2"
VEHICLE, PILOT = (f"harness/vehicles/{NAME}/{file}.toml" for file in ("vehicle", "pilot"))
PROFILE = f"hil_profiles/{NAME}.toml"
WRITTEN = {VEHICLE, PILOT, PROFILE}
ARDUPILOT = {f"harness/rigs/ardupilot/{NAME}.toml", f"hil_profiles/{NAME}.parm"}
SKETCH = {f"harness/firmware/{NAME}/{NAME}.ino", f"harness/trials/{NAME}-sketch.toml"}
SEA = {"sea.height": "0.3 m", "wind.speed": "6 m/s", "current.speed": "0.2 m/s"}
BELOW = ("rov", "auv")
every_kind = pytest.mark.parametrize("like", KINDS)


def new(folder, *arguments, like="usv", name=NAME):
    kind = () if arguments == ("sketch-of",) else ("--like", like)
    return seatrial("new", *(arguments or ("vehicle",)), name, *kind, cwd=folder)


def files(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def run(folder, *arguments):
    options = ("--engine", "direct", "--no-report", "--out", "out")
    return seatrial("run", *arguments, *options, cwd=folder)


@pytest.fixture
def made(tmp_path, request, monkeypatch):
    """Return the current folder, with the files of a vehicle."""
    monkeypatch.chdir(tmp_path)
    write(texts(NAME, getattr(request, "param", "usv")), "", [("", "")])
    return tmp_path


every_made = pytest.mark.parametrize("made", KINDS, indirect=True)


def like_of(request):
    return request.node.callspec.params["made"]


def set_out(seconds, **changes):
    """Return the vehicle's trial `under-way`, of so many seconds, in process."""
    settings = {"choices.vehicle": NAME, "stop": f"{seconds} s", **changes}
    return load_trial("under-way", changes=settings, origin="--set")


def rows(folder):
    with (folder / "signals.csv").open(encoding="utf-8") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


# ---------------------------------------------------------------------- what is written


@every_kind
def test_it_writes_three_files_and_says_what_next(like, tmp_path):
    done = new(tmp_path, like=like)
    assert done.returncode == 0, done.stderr
    written = files(tmp_path)
    assert written.keys() == WRITTEN
    for path, data in written.items():
        assert f"\n  {path}\n" in done.stdout
        assert b"@" not in data
    for command in (f"run {NAME}", f"describe sil --vehicle {NAME}", f"new trials {NAME}"):
        assert f"  seatrial {command} " in done.stdout


@every_made
def test_every_number_is_marked_as_invented(made):
    vehicle = tomllib.loads((made / VEHICLE).read_text("utf-8"))
    numbers = {k: v for k, v in vehicle.items() if k not in ("rig", "outline", "shape")}
    tables = [value for value in numbers.values() if isinstance(value, dict)]
    assert tables
    for table in tables:
        assert table["mark"] == "assumed"
        assert table["source"] == "invented"
        entries = [e for e in table.values() if isinstance(e, dict)]
        assert all("invented" in e.get("source", "invented") for e in entries)
    profile = tomllib.loads((made / PROFILE).read_text("utf-8"))
    sections = [*profile["actuators"].values(), *profile["sensors"].values(), profile["home"]]
    assert all("invented" in s["source"] or "no sensor" in s["source"] for s in sections)


@needs_kits("mavlink", "nmea")
@every_made
def test_the_profile_is_sound(made):
    profile = check_profile(NAME)
    for section in profile.sections():
        assert profile.notes(section) == []


@every_made
def test_the_pilot_follows_the_body(made):
    """A heavier body is a heavier one for its pilot; the file has each number once."""
    path = made / VEHICLE
    text = path.read_text("utf-8")
    line = next(line for line in text.splitlines() if line.startswith("mass "))
    path.write_text(text.replace(line, 'mass = "500 kg"'), "utf-8")
    surge = tomllib.loads(text)["hull"]["added_mass"]["value"][0]
    system = assemble(load_rig("sil", choices={"vehicle": NAME}), engine="direct")
    given = system.parts["autopilot.pilot.speed_hold"].given
    assert given["mass"].value == pytest.approx(500.0 + surge)


# ---------------------------------------------------------------------- what runs


@pytest.mark.slow
@every_made
def test_it_runs_in_waves_wind_and_current(made, request):
    result = run_trial(set_out(2, **SEA), made / "out", engine="direct")
    last = rows(result.folder)[-1]
    assert abs(last["vehicle.hull.position.z"]) + abs(last["vehicle.hull.attitude.theta"]) > 1e-4
    missed = any(note.endswith("wind: nothing in the rig meets it") for note in result.notes)
    assert missed == (like_of(request) in BELOW)


@pytest.mark.long
@every_made
def test_it_sets_out_to_the_east(made):
    assert run(made, NAME).returncode == 0


@needs_kits("native")
@pytest.mark.long
@pytest.mark.interop
@every_made
def test_all_engines_give_the_same_bytes(made):
    found = [
        run_trial(set_out(2, **SEA), made / engine, engine=engine).folder / "signals.csv"
        for engine in ("direct", "fmu", "native")
    ]
    first, *others = (path.read_bytes() for path in found)
    assert others == [first, first]


@pytest.mark.long
@every_made
def test_its_course_is_passed(made, request):
    assert new(made, "trials", like=like_of(request)).returncode == 0
    done = run(made, f"{NAME}-course")
    assert done.returncode == 0, done.stdout


@needs_kits("mavlink")
@pytest.mark.slow
@every_made
def test_it_waits_for_a_ground_station(made):
    links = ("--set", "autopilot.mavlink.links=", "--set", "stop=1 s")
    done = run(made, NAME, "--autopilot", "mavlink", *links)
    assert done.returncode == 0, done.stderr
    assert "PASS  nobody arms it" in done.stdout


@needs_kits("mavlink")
@pytest.mark.slow
def test_its_mission_runs_for_ground_stations(made):
    assert new(made, "trials").returncode == 0
    links = ("--set", "autopilot.mavlink.links=")
    done = run(made, f"{NAME}-mission", *links, "--set", "stop=5 s", "--real-time", "1e6")
    assert done.returncode == 0, done.stderr


@needs_kits("nmea")
def test_a_vehicle_under_an_autopilot_without_a_trial_of_its_own_sets_out(made):
    done = run(made, NAME, "--autopilot", "nmea0183", "--set", "stop=1 s")
    assert "it gets under way to the east" in done.stdout


def test_a_trial_of_the_same_name_comes_first(made):
    path = made / f"harness/trials/{NAME}.toml"
    path.parent.mkdir()
    path.write_text(f'rig = "vehicles/{NAME}"\nstop = "1 s"\n', "utf-8")
    done = run(made, NAME)
    assert done.returncode == 0, done.stderr
    assert "PASS" not in done.stdout


# ---------------------------------------------------------------------- what moves it


@pytest.mark.parametrize("made", ["rov"], indirect=True)
def test_eight_thrusters_drive_it_as_manual_control_says(made):
    pilot, hull = "autopilot.pilot", "vehicle.hull"
    settings = {f"{pilot}.guidance.mode": "manual", f"{hull}.position_start.z": 3.0}
    for axis, moved in (("surge", "u"), ("sway", "v"), ("heave", "w")):
        given = {**settings, f"{pilot}.guidance.manual.{axis}": 0.3}
        with Simulation("sil", choices={"vehicle": NAME}, set=given) as simulation:
            simulation.run("2 s")
            speeds = {a: simulation.get(f"{hull}.velocity.{a}") for a in "uvw"}
            assert abs(simulation.get(f"{hull}.attitude.theta")) < math.radians(3.0)
        assert speeds.pop(moved) > 0.1
        assert max(map(abs, speeds.values())) < 0.03


@pytest.mark.parametrize(
    ("made", "channel", "seconds"),
    [("ship", "rudder.pulse", 20), ("auv", "rudder.pulse", 4)],
    indirect=["made"],
)
def test_a_rudder_pulse_above_neutral_turns_it_to_starboard(made, channel, seconds):
    """So do the parameter files of ArduPilot take it."""
    with Simulation(f"vehicles/{NAME}") as simulation:
        simulation.set(channel, 1.7e-3)
        simulation.set("esc.pulse", 1.9e-3)
        simulation.run(float(seconds))
        assert simulation.get("hull.attitude.psi") > 0.01


@pytest.mark.parametrize("made", ["azimuth"], indirect=True)
def test_azimuths_turned_to_starboard_turn_it_to_port(made):
    """A servo rests within its dead band, 0.2 deg."""
    with Simulation(f"vehicles/{NAME}") as simulation:
        for side in ("port", "starboard"):
            simulation.set(f"{side}_esc.pulse", 1.7e-3)
            simulation.set(f"{side}_gear.pulse", 1.7e-3)
        simulation.run(4.0)
        assert simulation.get("hull.propulsor_turned.p1") == pytest.approx(math.pi / 4, abs=5e-3)
        assert simulation.get("hull.attitude.psi") < -0.05


MOVING = {
    "usv": {"propulsor_force.p1", "propulsor_force.p2"},
    "rov": {f"propulsor_force.p{k}" for k in range(1, 9)},
    "auv": {"foil_turned.f1", "foil_turned.f2", "propulsor_force.p1"},
    "azimuth": {f"propulsor_{p}" for p in ("turned.p1", "turned.p2", *(f"force.p{k}" for k in (1, 2, 3)))},
    "ship": {"foil_turned.f1", "propulsor_force.p1"},
}  # fmt: skip


@every_made
def test_its_drawing_moves_with_its_parts(made, request):
    shape = tomllib.loads((made / VEHICLE).read_text("utf-8"))["shape"]["hull"]
    moved = [part[kind] for part in shape for kind in ("turn", "stretch") if kind in part]
    assert {each["port"] for each in moved} == MOVING[like_of(request)]


@needs_kits("mavlink")
@pytest.mark.sampled(2)
@every_made
def test_its_components_are_drawn(made):
    """Of the usv under this autopilot Graphviz loses an edge at first."""
    arguments = ("sil", "--vehicle", NAME, "--autopilot", "mavlink", "--diagram", "rig.svg")
    done = seatrial("describe", *arguments, cwd=made)
    assert done.returncode == 0, done.stderr
    assert "autopilot.pilot.allocation" in (made / "rig.svg").read_text("utf-8")


# ---------------------------------------------------------------------- ArduPilot and sketch


@needs_kits("ardupilot", "nmea")
@every_kind
def test_what_ardupilot_needs_is_added(like, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(texts(NAME, like), "", [("", "")])
    done = new(tmp_path, "ardupilot", like=like)
    assert done.returncode == 0, done.stderr
    assert files(tmp_path).keys() == WRITTEN | ARDUPILOT
    assert f"added to\n  {PROFILE}\n" in done.stdout
    check_profile(NAME)
    values = dict(
        line.partition("#")[0].split()
        for line in (tmp_path / f"hil_profiles/{NAME}.parm").read_text("utf-8").splitlines()
        if line.partition("#")[0].strip()
    )
    channels = {actuator.channel for actuator in load_profile(NAME).file.actuators.values()}
    functions = {n: values.get(f"SERVO{n}_FUNCTION") for n in channels}
    assert None not in functions.values()  # Rover's own: steering on 1, throttle on 3
    for n in (n for n, function in functions.items() if function != "0"):
        ends = [float(values[f"SERVO{n}_{end}"]) for end in ("MIN", "TRIM", "MAX")]
        assert ends == [1100.0, 1500.0, 1900.0]


@needs_kits("arduino", "nmea")
@pytest.mark.slow
def test_its_sketch_turns_it_east(made):
    from tests.kits.arduino.bench import need

    need("host")
    assert new(made, "sketch-of").returncode == 0
    assert files(made).keys() == WRITTEN | SKETCH
    done = run(made, f"{NAME}-sketch", "--set", "stop=21 s")
    assert done.returncode == 0, done.stdout + done.stderr
    checked = seatrial(
        "sketch", "check", f"harness/firmware/{NAME}", "--profile", f"{NAME}:mega", cwd=made
    )
    assert "nothing is unsupported" in checked.stdout


def test_what_is_there_already_is_not_added(made):
    with (made / PROFILE).open("a", encoding="utf-8") as file:
        file.write('[links.ardupilot]\nkind = "ardupilot"\n')
    before = files(made)
    done = new(made, "ardupilot")
    assert done.returncode == 2
    assert f"{PROFILE} has a table [links.ardupilot] already" in done.stderr
    assert files(made) == before


def test_there_must_be_a_profile_to_add_to(tmp_path):
    done = new(tmp_path, "ardupilot")
    assert done.returncode == 2
    assert f"there is no {PROFILE} to add to: seatrial new vehicle {NAME} writes" in done.stderr
    assert files(tmp_path) == {}


# ---------------------------------------------------------------------- profiles cut short


@needs_kits("mavlink")
@pytest.mark.parametrize("made", ["usv", "auv"], indirect=True)
def test_under_guidance_its_profile_needs_actuators_and_sensors_only(made):
    path = made / PROFILE
    text = path.read_text("utf-8")
    cut = text[text.index("[actuators.") : text.index("[links.")]
    lines = [line for line in cut.splitlines() if not line.startswith("source")]
    path.write_text("\n".join(['title = "bare"', *lines]), "utf-8")
    done = run(made, NAME, "--set", "stop=1 s")
    assert done.returncode == 1, done.stderr
    assert f"note: profile {NAME}: actuators." in done.stdout
    done = run(made, NAME, "--autopilot", "mavlink", "--set", "stop=1 s")
    assert "unknown section 'links.ground'" in done.stderr


@needs_kits("mavlink", "nmea")
def test_what_a_link_takes_by_default_is_a_note(made):
    path = made / PROFILE
    text = path.read_text("utf-8")
    path.write_text(text[: text.index("[identity]")] + text[text.index("[actuators.") :], "utf-8")
    links = ("--set", "autopilot.mavlink.links=", "--set", "stop=1 s")
    done = run(made, NAME, "--autopilot", "mavlink", *links)
    assert done.returncode == 0, done.stderr
    note = f"note: profile {NAME}: links.ground has defaults for what [identity] and [home] do not"
    assert note in done.stdout
    assert note in seatrial("profile", "check", NAME, cwd=made).stdout


# ---------------------------------------------------------------------- what is refused


def test_a_second_call_writes_nothing(made):
    (made / VEHICLE).write_text("mine", "utf-8")
    (made / PROFILE).unlink()
    before = files(made)
    done = new(made)
    assert done.returncode == 2
    assert f"nothing is written, for there is already {PILOT}" in done.stderr
    assert files(made) == before


def test_a_file_in_the_place_of_a_folder_is_refused(tmp_path):
    (tmp_path / "harness").write_text("mine", "utf-8")
    done = new(tmp_path)
    assert done.returncode == 2
    assert "there is already harness\n" in done.stderr
    assert files(tmp_path) == {"harness": b"mine"}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        *((bad, f"NAME {bad!r}: letters") for bad in ("a b", "../x", "a.b", "é", "con", "LPT1")),
        ("", "NAME '': letters"),
        ("x" * 41, "40 at most"),
        ("{vehicle}", "NAME '{vehicle}': letters"),
        ("hydrone", "seatrial ships harness/vehicles/hydrone/pilot.toml, "),
    ],
)
def test_names_that_cannot_be(name, expected, tmp_path):
    done = new(tmp_path, name=name)
    assert done.returncode == 2
    assert expected in done.stderr
    assert files(tmp_path) == {}


@pytest.mark.parametrize("command", ["vehicle", "trials", "ardupilot"])
def test_kinds_that_are_none(command, tmp_path):
    done = new(tmp_path, command, like="uvs")
    assert done.returncode == 2
    assert "--like: unknown kind of vehicle 'uvs'; did you mean 'usv' or" in done.stderr
