"""SSP packages written: valid, the same bytes each time, and read back as the same rig."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmpy.ssp.ssd import read_ssd, validate_tree
from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.trial.files.trial import load_trial
from seatrial_kits.interchange.export import export_ssp
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.interchange.ssp.tools import findings
from tests import users

from ...fmi.native import changed
from .ssp_files import BOATS, rows

RIG = """
step = "10 ms"
[components]
compass = {{ fmu = "boats.py:Compass" }}
hull = {{ fmu = "{hull}", set = {{ mass = "4000 g", label = "a & <b>" }}, step = "20 ms" }}
damper = {{ fmu = "boats.py:Damper" }}
[connections]
"hull.v" = {{ to = "damper.v", factor = 3.0, offset = 0.1 }}
"damper.force" = "hull.force"
"compass.angle" = "hull.angle"
"""


@pytest.fixture
def rig(write) -> Path:
    write("boats.py", BOATS)
    return write("quay.toml", RIG.format(hull="boats.py:Hull"))


def test_a_package_reads_back_as_the_rig_it_was(rig: Path, tmp_path: Path) -> None:
    path, notes = export_ssp(str(rig), tmp_path / "x.ssp")
    read = read_ssp(path)
    assert (read.start, read.stop, read.notes) == ("0.0 s", "10.0 s", ())
    assert rows(assemble(read.rig), 40) == rows(assemble(load_rig(str(rig))), 40)
    assert any("'jacobi' cannot be said" in note for note in notes)
    assert any("no stop time: the package says 10 s" in note for note in notes)


@pytest.mark.slow
def test_the_same_rig_gives_the_same_bytes(rig: Path, tmp_path: Path) -> None:
    first, _ = export_ssp(str(rig), tmp_path / "a.ssp")
    second, _ = export_ssp(str(rig), tmp_path / "b.ssp")
    assert first.read_bytes() == second.read_bytes()


def test_a_package_fits_the_schemas_and_says_what_the_rig_says(rig: Path, tmp_path: Path) -> None:
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp")
    with zipfile.ZipFile(path) as archive:
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert max(info.extract_version for info in archive.infolist()) <= 20  # no ZIP64
        validate_tree(
            etree.fromstring(archive.read("resources/hull.ssv")),
            "SystemStructureParameterValues.xsd",
        )
        text = archive.read("SystemStructure.ssd").decode()
    described = read_ssd(str(path))  # FMPy validates what it reads
    components = {c.name: c for c in described.system.elements}
    inputs = [c.name for c in components["hull"].connectors if c.kind == "input"]
    assert inputs == ["force", "angle"]  # the connected ones
    assert '<ssc:LinearTransformation factor="3.0" offset="0.1"/>' in text
    assert '<ssc:LinearTransformation factor="0.017453292519943295" offset="0.0"/>' in text
    assert text.count('suppressUnitConversion="true"') == 2
    assert '<osp:StepSizeHint value="0.02"/>' in text
    assert '<ssc:BaseUnit rad="1" factor="0.017453292519943295"/>' in text


def test_nothing_is_found_against_a_package_of_ours_but_what_tools_leave_out(
    rig: Path, tmp_path: Path
) -> None:
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp")
    assert [one for one in findings(path) if one.rejects] == []


@pytest.mark.slow
def test_an_fmu_of_somebody_else_is_copied_as_it_is(write, tmp_path: Path) -> None:
    write("boats.py", BOATS)
    plain = write("plain.toml", RIG.format(hull="boats.py:Hull"))
    with zipfile.ZipFile(export_ssp(str(plain), tmp_path / "a.ssp")[0]) as archive:
        data = archive.read("resources/hull.fmu")
    (tmp_path / "other.fmu").write_bytes(data)
    other = write("other.toml", RIG.format(hull="other.fmu"))
    path, notes = export_ssp(str(other), tmp_path / "b.ssp")
    with zipfile.ZipFile(path) as archive:
        assert archive.read("resources/hull.fmu") == data
    assert any("other.fmu is copied as it is" in note for note in notes)


def test_a_trial_carries_its_settings_and_names_what_is_left_out(rig: Path, write) -> None:
    trial = write(
        "dash.toml",
        'rig = "quay.toml"\nstart = "1 s"\nstop = "3 s"\nset = { "hull.mass" = "5 kg" }\n'
        '[[events]]\nat = "2 s"\nset = { "hull.on" = true }\n'
        '[[criteria]]\nname = "slow"\ncheck = "hull.v < 2 m/s"\n',
    )
    path, notes = export_ssp(str(trial), trial.with_name("x.ssp"))
    again = load_trial(str(path))
    assert (again.start_ns, again.stop_ns) == (10**9, 3 * 10**9)
    assert again.rig.file.components["hull"].set["mass"] == 5.0
    assert sum("it has none" in note for note in notes) == 2


@pytest.mark.slow
def test_seeds_travel_as_parameters(tmp_path: Path) -> None:
    path, _ = export_ssp("landing", tmp_path / "x.ssp")
    read = read_ssp(path).rig.components
    sensors = [f"vehicle.{name}" for name in ("gnss", "compass", "imu")]
    seeds = {name: read[name].entry.set["seed"] for name in sensors}
    assert len(set(seeds.values())) == 3
    assert all(isinstance(seed, float) and seed > 0.0 for seed in seeds.values())


@pytest.mark.parametrize(
    ("source", "output"),
    [
        ('"users.py:Ramp"', "y"),
        ('"mavlink", set = { tunables = "RATE 1 0 2" }', "tunable.t1"),  # by hand, of no profile
    ],
)
def test_a_connection_to_a_parameter_is_refused(
    source: str, output: str, write, tmp_path: Path
) -> None:
    write("users.py", users.CHAIN)
    rig = write(
        "knob.toml",
        f"""step = "10 ms"
[components]
knob = {{ fmu = {source} }}
sum = {{ fmu = "users.py:Sum" }}
[connections]
"knob.{output}" = {{ to = "sum.rate", convert = false }}
""",
    )
    said = rf"knob\.{output} feeds the parameter sum\.rate, for which SSP"
    with pytest.raises(InputError, match=said):
        export_ssp(str(rig), tmp_path / "knob.ssp")
    assert not (tmp_path / "knob.ssp").exists()


def test_a_name_that_is_neither_trial_nor_rig_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'landing'"):
        export_ssp("landin", tmp_path / "x.ssp")
    assert list(tmp_path.iterdir()) == []


def test_a_package_written_again_is_the_same_system(rig: Path, tmp_path: Path) -> None:
    first, _ = export_ssp(str(rig), tmp_path / "a.ssp")
    with pytest.raises(InputError, match="would replace what it is made from"):
        export_ssp(str(first), first)
    second, _ = export_ssp(str(first), tmp_path / "b.ssp")
    assert rows(assemble(read_ssp(second).rig), 10) == rows(assemble(read_ssp(first).rig), 10)


SPEEDS = '''
"""A log and a display."""
from seatrial.model.component import Component, Input, Output


class Log(Component):
    """36 km/h."""

    speed = Output("km/h", "speed")

    def outputs(self, t):
        self.speed = 36.0


class Display(Component):
    """Shows what it gets."""

    speed = Input("m/s", "speed")
    force = Input("N", "force")
    shown = Output("m/s", "speed")
    shown_force = Output("N", "force")
    feedthrough = {"shown": ("speed",), "shown_force": ("force",)}

    def outputs(self, t):
        self.shown, self.shown_force = self.speed, self.force
'''
SHOWN = """
step = "10 ms"
[components]
log = { fmu = "LOG" }
raw = { fmu = "DISPLAY" }
twice = { fmu = "DISPLAY" }
[connections]
"log.speed" = [
    { to = "raw.speed", convert = false },
    { to = "raw.force", convert = false },
    { to = "twice.speed", factor = 3.6 },
]
"""


@pytest.mark.slow
def test_connections_that_do_not_convert_units_do_not_when_read_back(write, tmp_path: Path) -> None:
    write("speeds.py", SPEEDS)
    text = SHOWN.replace("LOG", "speeds.py:Log").replace("DISPLAY", "speeds.py:Display")
    rig = write("shown.toml", text)
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp")
    (row,) = rows(assemble(read_ssp(path).rig), 1)
    assert [row["raw.shown"], row["raw.shown_force"], row["twice.shown"]] == [36.0, 36.0, 36.0]
    with zipfile.ZipFile(path) as archive:
        text = archive.read("SystemStructure.ssd").decode()
    assert text.count('suppressUnitConversion="true"') == 3


@pytest.mark.parametrize("name", ["kn", "t", "T", "wombat"])
def test_units_that_an_fmu_defines_otherwise_are_written_as_it_means_them(
    name: str, write, tmp_path: Path
) -> None:
    # A kilonewton that is called a knot, a tonne or a tesla.
    folder = write("speeds.py", SPEEDS.replace("km/h", "kN").replace('"m/s"', '"N"')).parent
    for source in ("Log", "Display"):
        found = find_source(f"speeds.py:{source}", folder)
        assert isinstance(found, ComponentSource)
        built = build_fmu(found, tmp_path / "built.fmu")
        if source == "Log":
            changed(built, tmp_path / f"{source}.fmu", ('"kN"', f'"{name}"'))
        else:
            built.rename(tmp_path / f"{source}.fmu")
    text = SHOWN.replace("LOG", "Log.fmu").replace("DISPLAY", "Display.fmu")
    rig = write("shown.toml", text.replace("factor = 3.6", "factor = 2.0"))
    path, notes = export_ssp(str(rig), tmp_path / "x.ssp")
    (row,) = rows(assemble(read_ssp(path).rig), 1)
    assert [row["raw.shown"], row["twice.shown"]] == [36.0, 72_000.0]
    assert not any("is not written" in note for note in notes)
