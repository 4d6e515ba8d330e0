"""FMUs of FMI 3.0 that we build: the same signals as in FMI 2.0, and what only 3.0 has."""

from __future__ import annotations

import ctypes
import random
import re
import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from lxml import etree
from pymavlink import mavutil

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.compiler import HERE, checked_platforms, library_here
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.fmi.version3.sources import front_sources
from seatrial.links.text import encode, packed, unpacked
from seatrial.model.component import Component, Input, Output
from seatrial.system.files import find_file
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.native.standalone.export import build_standalone_fmu
from tests.command import seatrial
from tests.fmi.native_slave3 import Slave3
from tests.interop.running import free_port

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

HEADERS = Path(fmpy.__file__).parent / "c-code"
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
HOST = Path(__file__).parent / "slaves" / "host3.c"


def native(name: str, folder: Path, values: Any = None) -> Path:
    source = find_source(name, Path.cwd())
    path = folder / f"{source.name}.fmu"
    return build_native_fmu(source, path, (HERE,), values, library_here, 3)


def python(name: str, folder: Path) -> Path:
    source = find_source(name, Path.cwd())
    assert isinstance(source, ComponentSource)
    path = folder / f"{source.name}.fmu"
    return build_fmu(source, path, None, 3, (HERE,), library_here)


def _valid(archive: zipfile.ZipFile, member: str, schema: str) -> Any:
    root = etree.fromstring(archive.read(member))
    etree.XMLSchema(etree.parse(SCHEMAS / schema)).assertValid(root)
    return root


@pytest.mark.slow
def test_files_are_valid_and_all_functions_exported(tmp_path: Path) -> None:
    path = native("gnss", tmp_path)
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        terminals = "terminalsAndIcons/terminalsAndIcons.xml"
        listed = _valid(archive, terminals, "fmi3TerminalsAndIcons.xsd")
        build = _valid(archive, "sources/buildDescription.xml", "fmi3BuildDescription.xsd")
        names = {f"sources/{e.get('name')}" for e in build.iter("SourceFile")}
        assert names == {n for n in archive.namelist() if n.endswith(".c")}
        members = {e.get("variableName") for e in listed.iter("TerminalMemberVariable")}
        archive.extract("binaries/x86_64-linux/gnss.so", tmp_path)
    model = fmpy.read_model_description(str(path))
    assert members <= {v.name for v in model.modelVariables}
    library = tmp_path / "binaries/x86_64-linux/gnss.so"
    nm = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True)
    header = (HEADERS / "fmi3Functions.h").read_text("utf-8")
    functions = re.findall(r"FMI3_Export fmi3\w+TYPE\s+(fmi3\w+);", header)
    assert sorted(line.split()[-1] for line in nm.stdout.splitlines()) == sorted(functions)


@pytest.mark.parametrize("name", ["gnss", "nmea0183", "canbus"])
def test_our_importer_sees_what_it_sees_in_fmi_2(name: str, tmp_path: Path) -> None:
    """Names, types, units, limits, start values, roles, what depends on what, terminals."""
    source = find_source(name, Path.cwd())
    assert isinstance(source, ComponentSource)
    old = load_fmu(build_fmu(source, tmp_path / "old.fmu"))
    new = load_fmu(python(name, tmp_path))
    assert validate_fmu(str(tmp_path / f"{name}.fmu")) == []
    compared = (
        *("name", "causality", "variability", "type", "unit", "start", "minimum", "maximum"),
        *("nominal", "description", "optional", "frame", "term_of", "role"),
    )
    seen = [
        [[getattr(v, what) for what in compared] for v in fmu.variables.values()]
        for fmu in (old, new)
    ]
    assert seen[1][:-1] == seen[0]
    assert seen[1][-1][:2] == ["time", "independent"]
    assert new.feedthrough == old.feedthrough
    assert new.terminals == old.terminals
    assert len(new.arrays) < len(new.variables)


@pytest.mark.interop
def test_a_rig_of_native_fmus_has_the_same_record(tmp_path: Path) -> None:
    """A drone lands, hull and downwash in C of FMI 3.0, parameters by the rig."""
    for name in ("marine-craft", "downwash"):
        build = ["fmu", "build", name, "--native", "--fmi", "3", "--parameters", "hydrone"]
        assert seatrial(*build, cwd=tmp_path).returncode == 0
    _same_record(tmp_path, "hydrone-open-loop", "hydrone-open-landing", 'parameters = "hydrone.{}"')
    # Packages name elements as other tools know them, and are read back.
    records = []
    for rig, version in (("rig.toml", "1.0"), ("rig.toml", "2.0"), ("hydrone-open-loop", "1.0")):
        export = ["ssp", "export", rig, "--version", version, "--out", "x.ssp"]
        assert seatrial(*export, cwd=tmp_path).returncode == 0
        with zipfile.ZipFile(tmp_path / "x.ssp") as archive:
            described = archive.read("SystemStructure.ssd").decode()
        assert ("hydrone" in rig) == ('name="attitude.psi"' in described)
        assert seatrial("run", "x.ssp", "--out", f"{rig}-{version}", cwd=tmp_path).returncode == 0
        records.append((tmp_path / f"{rig}-{version}" / "signals.csv").read_bytes())
    assert records[0] == records[1] == records[2]


@pytest.mark.interop
def test_a_rig_of_python_fmus_has_the_same_record(tmp_path: Path) -> None:
    """A CAN bus: its frames, which are text in FMI 2.0, are Binary."""
    assert seatrial("fmu", "build", "canbus", "can-traffic", "--fmi", "3.0", cwd=tmp_path).stdout
    _same_record(tmp_path, "can-faults", "can-load")
    model = fmpy.read_model_description(str(tmp_path / "can-traffic.fmu"))
    assert {v.name: v.type for v in model.modelVariables}["rx"] == "Binary"


def _same_record(folder: Path, rig: str, trial: str, parameters: str = "") -> None:
    text = find_file("harness/rigs", rig).read_text("utf-8")
    for name in (path.stem for path in folder.glob("*.fmu")):
        assert f'fmu = "{name}"' in text
        text = text.replace(
            f'fmu = "{name}", parameters = "hydrone"', f'fmu = "{name}", {parameters.format(name)}'
        )
        text = text.replace(f'fmu = "{name}"', f'fmu = "{name}.fmu"')
    (folder / "rig.toml").write_text(text, "utf-8")
    own = find_file("harness/trials", trial).read_text("utf-8")
    own = re.sub(r'^rig( *)= "[\w-]+"', r'rig\1= "rig.toml"', own, flags=re.MULTILINE)
    (folder / "trial.toml").write_text(own, "utf-8")
    records = []
    for name in ("trial.toml", trial):
        done = seatrial("run", name, "--out", f"run-{len(records)}", cwd=folder)
        assert done.returncode == 0, done.stderr
        records.append((folder / f"run-{len(records)}" / "signals.csv").read_bytes())
    assert records[0].count(b"\n") > 400
    assert records[0] == records[1]


@pytest.mark.interop
def test_derivatives_are_those_of_differences(tmp_path: Path) -> None:
    """Along random directions of all inputs; and the adjoint ones are their transpose."""
    slave = Slave3(native("marine-craft", tmp_path), tmp_path)
    slave.begin()
    variables = slave.description.modelVariables
    draw = random.Random(1)
    inputs = [v for v in variables if v.causality == "input"]
    outputs = [v for v in variables if v.causality == "output"]
    knowns, unknowns = ([v.valueReference for v in group] for group in (inputs, outputs))
    by = [r for v in inputs for r in slave.whole[v.valueReference & 0xFFFFF][1]]
    of = [r for v in outputs for r in slave.whole[v.valueReference & 0xFFFFF][1]]
    for k in range(5):
        slave.setReal(by, [slave.values[r] + draw.uniform(-0.5, 0.5) for r in by])
        slave.doStep(0.1 * k, 0.1)
    seed = [draw.uniform(-1.0, 1.0) for _ in by]
    along = slave.fmu3.getDirectionalDerivative(unknowns, knowns, seed, len(of))
    at, step, found = [slave.values[r] for r in by], 1e-4, []
    for side in (1.0, -1.0):
        slave.setReal(by, [a + side * step * s for a, s in zip(at, seed, strict=True)])
        found.append(slave.getReal(of))
    slave.setReal(by, at)
    differences = [(a - b) / (2 * step) for a, b in zip(*found, strict=True)]
    assert along == pytest.approx(differences, rel=1e-6, abs=1e-6)
    assert any(abs(value) > 1e-3 for value in along)
    weights = [draw.uniform(-1.0, 1.0) for _ in of]
    back = slave.fmu3.getAdjointDerivative(unknowns, knowns, weights, len(by))
    forward = sum(w * a for w, a in zip(weights, along, strict=True))
    assert sum(b * s for b, s in zip(back, seed, strict=True)) == pytest.approx(forward, rel=1e-12)
    with pytest.raises(Exception, match="fmi3GetDirectionalDerivative"):
        slave.fmu3.getDirectionalDerivative(unknowns, unknowns, [1.0] * len(of), len(of))
    assert "there is no derivative by" in slave.messages[-1]


@pytest.mark.interop
def test_before_the_run_states_follow_their_start_values(tmp_path: Path) -> None:
    slave = Slave3(native("marine-craft", tmp_path), tmp_path)
    slave.fmu3.enterInitializationMode(startTime=0.0)
    by_name = {v.name: v.valueReference for v in slave.description.modelVariables}
    known, unknown = by_name["velocity_start"], by_name["velocity"]
    seed = [1.0, 2.0, 3.0]
    assert slave.fmu3.getDirectionalDerivative([unknown], [known], seed, 3) == seed
    slave.fmu3.exitInitializationMode()


@pytest.mark.interop
@pytest.mark.parametrize(
    ("name", "input_", "output"),
    [("marine-craft", "force_1", "position"), ("gnss", "position", "position_n")],
)
def test_sanitizers_find_nothing(name: str, input_: str, output: str, tmp_path: Path) -> None:
    """A host in C that also does what it must not; another compiler's warnings and checks."""
    path = native(name, tmp_path)
    fmpy.extract(str(path), str(tmp_path / "fmu"))
    sources = tmp_path / "fmu" / "sources"
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-std=c99"]
    for source in front_sources():
        if source.endswith(".c"):
            command = ["cc", *strict, "-c", str(sources / source), "-o", str(tmp_path / "x.o")]
            subprocess.run(command, check=True)
    model = fmpy.read_model_description(str(path))
    references = {v.name: str(v.valueReference) for v in model.modelVariables}
    program, flags = tmp_path / "host", ["-fsanitize=address,undefined", "-fno-sanitize-recover"]
    command = ["cc", "-Wall", "-Werror", *flags, f"-I{sources}", str(HOST)]
    command += [*map(str, sources.glob("*.c")), "-o", str(program), "-lm"]
    subprocess.run(command, check=True)
    run = subprocess.run(
        [program, model.instantiationToken, references[input_], references[output]],
        capture_output=True,
        text=True,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "12 complaints\n", "")


class Echo(Component):
    """Sends back the bytes that it gets, and refuses a voltage of its own."""

    rx = Input("1", "bytes", type=str, role="bytes")
    u = Input("V", "voltages", axes=("red", "green"))
    tx = Output("1", "the same bytes", type=str, role="bytes")
    y = Output("V", "the voltages", axes=("red", "green"))
    n = Output("1", "whole numbers", type=int, axes=("one", "two"))
    flags = Output("1", "truths", type=bool, axes=("one", "two"))

    def outputs(self, t: float) -> None:
        if self.u[0] > 5.0:
            raise SimulationError(f"{self.name}: {self.u[0]} V is too much")
        self.tx, self.y, self.n, self.flags = self.rx, self.u, (1, -2), (True, False)


def _opened(
    path: Path, folder: Path, initialised: bool = True
) -> tuple[FMU3Slave, dict[str, int], list[str]]:
    model, messages = fmpy.read_model_description(str(path)), []
    fmpy.extract(str(path), str(folder / "unpacked"))
    slave = FMU3Slave(
        guid=model.guid,
        unzipDirectory=str(folder / "unpacked"),
        modelIdentifier=model.coSimulation.modelIdentifier,
        instanceName="x",
    )
    slave.instantiate(logMessage=lambda _e, _s, _c, text: messages.append(text.decode()))
    if initialised:
        slave.enterInitializationMode(startTime=0.0)
    return slave, {v.name: v.valueReference for v in model.modelVariables}, messages


@pytest.mark.slow
def test_bytes_and_arrays_of_a_python_component(tmp_path: Path) -> None:
    path = python(f"{__file__}:Echo", tmp_path)
    assert validate_fmu(str(path)) == []
    slave, reference, messages = _opened(path, tmp_path)
    slave.exitInitializationMode()
    # As the page says it: sequence 7; at 1.5 s three bytes, at 2 s none.
    content = struct.pack("<Q", 7) + struct.pack("<QI", 1_500_000_000, 3) + b"\0\xff\1"
    content += struct.pack("<QI", 2_000_000_000, 0)
    slave.setBinary([reference["rx"]], [content])
    slave.setFloat64([reference["u"]], [1.0, 2.0])
    slave.doStep(0.0, 0.1)
    assert slave.getBinary([reference["tx"]]) == [content]
    assert slave.getFloat64([reference["y"], reference["time"]], 3) == [1.0, 2.0, 0.1]
    assert slave.getInt32([reference["n"]], 2) == [1, -2]
    assert slave.getBoolean([reference["flags"]], 2) == [True, False]
    for wrong in (b"1234567", content[:-1], content + b"\0"):
        with pytest.raises(Exception, match="fmi3SetBinary"):
            slave.setBinary([reference["rx"]], [wrong])
        assert messages.pop().endswith("bytes are no chunks")
    slave.setFloat64([reference["u"]], [6.0, 2.0])
    with pytest.raises(Exception, match="fmi3GetFloat64"):
        slave.getFloat64([reference["y"]], 2)
    assert messages == ["x: 6.0 V is too much"]
    with pytest.raises(Exception, match="fmi3DoStep"):
        slave.doStep(0.1, 0.1)
    slave.reset()
    slave.enterInitializationMode(startTime=0.0)
    slave.exitInitializationMode()
    slave.terminate()
    slave.freeInstance()


def test_our_importer_has_bytes_as_text(tmp_path: Path) -> None:
    instance = open_instance(load_fmu(python(f"{__file__}:Echo", tmp_path)), "echo")
    instance.initialise(0.0, 1.0)
    instance.begin()
    text = encode(3, [(10, b"Hello"), (20, b"")])
    instance.writer(["rx", "u.green"])([text, 2.5])
    instance.step(0.0, 0.1)
    assert instance.reader(["tx", "y.red", "y.green", "n.two"])() == [text, 0.0, 2.5, -2]
    state = instance.get_state()
    instance.writer(["rx"])([""])
    instance.step(0.1, 0.1)
    assert instance.reader(["tx"])() == [""]
    instance.set_state(state)
    assert instance.reader(["tx"])() == [text]
    instance.free_state(state)
    instance.terminate()
    instance.free()


@pytest.mark.interop
def test_a_ground_station_sees_a_vehicle(tmp_path: Path) -> None:
    """The link of `mavlink`, stepped at the pace of the wall clock by FMPy."""
    station = mavutil.mavlink_connection(f"udpin:127.0.0.1:{(port := free_port())}")
    slave, reference, messages = _opened(python("mavlink", tmp_path), tmp_path, initialised=False)
    slave.setString([reference["links"]], [f"udpout:127.0.0.1:{port}"])
    slave.enterInitializationMode(startTime=0.0)
    slave.exitInitializationMode()
    heartbeat, step = None, 0.05
    for k in range(200):
        slave.doStep(k * step, step)
        heartbeat = station.recv_match(type="HEARTBEAT", blocking=True, timeout=step)
        if heartbeat is not None:
            break
    slave.terminate()
    slave.freeInstance()
    station.close()
    assert messages == []
    assert heartbeat is not None
    assert heartbeat.type == mavutil.mavlink.MAV_TYPE_SURFACE_BOAT


@pytest.mark.long
def test_binaries_for_others(tmp_path: Path) -> None:
    """Where FMI 3.0 has them, with its functions, and those of FMI 2.0 not exported."""
    names = {"x86_64-linux": ".so", "aarch64-linux": ".so", "x86_64-windows": ".dll"}
    names |= {"x86_64-darwin": ".dylib", "aarch64-darwin": ".dylib"}
    source = find_source("thruster", Path.cwd())
    path = tmp_path / "thruster.fmu"
    build_native_fmu(source, path, checked_platforms(",".join(names)), version=3)
    both = checked_platforms("x86_64-linux,x86_64-windows")
    build_fmu(source, tmp_path / "python.fmu", None, 3, both)
    with zipfile.ZipFile(path) as archive:
        for name, suffix in names.items():
            library = archive.read(f"binaries/{name}/thruster{suffix}")
            assert b"fmi3SetFloat64" in library
        mac = archive.read("binaries/aarch64-darwin/thruster.dylib")
        assert struct.unpack_from("<II", mac) == (0xFEEDFACF, 0x0100000C)
    with zipfile.ZipFile(tmp_path / "python.fmu") as archive:
        windows = archive.read("binaries/x86_64-windows/thruster.dll")
        assert b"fmi3SetFloat64" in windows
        assert archive.getinfo("resources/pythonfmu/pythonfmu-export.dll").file_size > 10_000
    with pytest.raises(InputError, match="unknown platform 'darwin64'"):
        build_fmu(source, tmp_path / "mac.fmu", None, 3, ["darwin64"])


@pytest.mark.long
def test_a_standalone_one(tmp_path: Path) -> None:
    """In this process its Python is used: the same results as the FMU that needs one."""
    source = find_source("gnss", Path.cwd())
    assert isinstance(source, ComponentSource)
    carrying = tmp_path / "carrying.fmu"
    build_standalone_fmu(source, carrying, version=3)
    assert validate_fmu(str(carrying)) == []
    found, expected = (
        fmpy.simulate_fmu(str(each), stop_time=2.0, output_interval=0.05)
        for each in (carrying, python("gnss", tmp_path))
    )
    assert found.tobytes() == expected.tobytes()


@pytest.mark.interop
def test_both_packings_are_one(tmp_path: Path) -> None:
    """C and Python, on random chunks and on texts and bytes that are none."""
    for name, content in front_sources().items():
        (tmp_path / name).write_bytes(content)
    library = tmp_path / "chunks.so"
    command = ["cc", "-shared", "-fPIC", str(tmp_path / "chunks.c"), "-o", str(library)]
    subprocess.run(command, check=True)
    chunks = ctypes.CDLL(str(library))
    chunks.chunks_from_text.restype = chunks.chunks_to_text.restype = ctypes.c_longlong
    draw = random.Random(1)

    def from_text(text: str) -> bytes | None:
        to = ctypes.create_string_buffer(8 + 4 * len(text))
        size = chunks.chunks_from_text(text.encode(), to)
        return None if size < 0 else to.raw[:size]

    def to_text(content: bytes) -> str | None:
        to = ctypes.create_string_buffer(32 + 3 * len(content))
        size = chunks.chunks_to_text(content, ctypes.c_size_t(len(content)), to)
        return None if size < 0 else to.value.decode()

    for _ in range(300):
        sent = [
            (draw.randrange(2 ** draw.randrange(1, 64)), draw.randbytes(draw.randrange(9)))
            for _ in range(draw.randrange(4))
        ]
        text = encode(draw.randrange(2 ** draw.randrange(1, 64)), sent)
        content = packed(text)
        assert from_text(text) == content
        assert to_text(content) == unpacked(content) == text
        cut = content[: draw.randrange(1, len(content) + 1)]
        assert to_text(cut) == _or_none(unpacked, cut)
        place = draw.randrange(len(text))
        changed = text[:place] + draw.choice("=;:*9A-") + text[place + 1 :]
        assert from_text(changed) is None or from_text(changed) == _or_none(packed, changed)
    assert from_text("") == b"" == packed("")
    assert to_text(b"") == "" == unpacked(b"")


def _or_none(convert: Any, value: Any) -> Any:
    try:
        return convert(value)
    except InputError:
        return None


@pytest.mark.interop
@pytest.mark.skipif(shutil.which("cmake") is None, reason="FMPy compiles sources with CMake")
def test_fmpy_compiles_the_sources(tmp_path: Path) -> None:
    """By buildDescription.xml alone; the same results as our binary's."""
    path = native("gnss", tmp_path)
    expected = fmpy.simulate_fmu(str(path), stop_time=2.0, output_interval=0.05)
    command = [sys.executable, "-m", "fmpy", "compile", str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (
        fmpy.simulate_fmu(str(path), stop_time=2.0, output_interval=0.05).tobytes()
        == expected.tobytes()
    )


def test_platforms_by_either_name() -> None:
    assert checked_platforms("x86_64-windows, linux64,aarch64-darwin") == [
        *("win64", "linux64", "aarch64-darwin"),
    ]
    with pytest.raises(InputError, match="unknown platform 'x86'"):
        checked_platforms("x86")


def test_a_version_that_there_is_not(tmp_path: Path) -> None:
    run = seatrial("fmu", "build", "gnss", "--fmi", "1", cwd=tmp_path)
    assert run.returncode == 2
    assert "unknown version of FMI '1'" in run.stderr
    assert list(tmp_path.iterdir()) == []
