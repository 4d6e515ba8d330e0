"""Native FMUs: the numbers of the Python carrier, hosts without Python, binaries for others."""

from __future__ import annotations

import math
import random
import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from seatrial.errors import InputError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.components.source import find_source
from seatrial.model.component import Component, Input, Parameter
from seatrial.model.plant import Plant, State
from seatrial_kits.native.cached import native_fmu
from seatrial_kits.native.carriers import why_python
from seatrial_kits.native.export import build_native_fmu
from tests.command import seatrial
from tests.fmi.native_slave import Slave

pytest.importorskip("ziglang")

HOST = Path(__file__).parents[2] / "fmi" / "slaves" / "host.c"
NATIVE = [
    name
    for name in components().names()
    if issubclass(component_class(name), Plant) and not why_python(component_class(name))
]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux")


def built(name: str, folder: Path, start_values=None, platforms=None) -> Path:
    """Build by this machine's compiler, or Zig's for the platforms named."""
    source = find_source(name, Path.cwd())
    path = folder / f"{source.stem}.fmu"
    if platforms:
        return build_native_fmu(source, path, platforms, start_values)
    return build_native_fmu(source, path, (HERE,), start_values, library_here)


def fresh(name: str, start_values) -> Component:
    component = component_class(name)("x")
    for port, value in start_values.items():
        component.set(port, value)
    return component


def whole(name: str) -> dict[str, object]:
    """Values with which everything in a component acts, but for its surroundings."""
    ports = component_class(name).ports
    exercised = component_class(name).exercised
    return {n: v for n, v in exercised.items() if n in ports and not ports[n].role}


def test_most_plants_are_native() -> None:
    assert len(NATIVE) >= 8
    assert "marine-craft" in NATIVE


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",  # the compiler takes many seconds for the largest
    [n if n == "marine-craft" else pytest.param(n, marks=pytest.mark.long) for n in NATIVE],
)
def test_same_numbers_to_the_bit(name: str, tmp_path: Path) -> None:
    start_values = whole(name)
    slave = Slave(built(name, tmp_path, start_values), tmp_path)
    assert validate_fmu(str(tmp_path / f"{name.replace('-', '_')}.fmu")) == []
    python = fresh(name, start_values)
    python.setup(0.0)
    python.initialise()
    slave.begin()
    python.begin()
    inputs = [s for s in python.scalars if s.port.kind == "input"]
    outputs = [s.reference for s in python.scalars if s.port.kind == "output"]
    assert [slave.reference[s.name] for s in python.scalars] == list(range(len(python.scalars)))
    source, moved = random.Random(1), set()
    for k in range(60):
        values = [s.port.start[s.index] + source.uniform(-0.2, 0.2) for s in inputs]
        references = [s.reference for s in inputs]
        slave.fmu.setReal(references, values)
        python.write(references, values, float)
        h = (0.01, 0.025, 0.004)[k % 3]
        t = python.now
        slave.fmu.doStep(t, h)
        python.advance(t, h)
        found = slave.fmu.getReal(outputs)
        assert [v.hex() for v in found] == [v.hex() for v in python.read(outputs, float)]
        moved.add(tuple(found))
    assert len(moved) == 60
    slave.fmu.terminate()
    slave.fmu.freeInstance()


@pytest.mark.slow
def test_a_shipped_trial_has_the_same_record(tmp_path: Path) -> None:
    """A drone lands on a native hull, the rest of the rig in process, parameters by the rig."""
    harness = Path(__file__).parents[3] / "harness"
    build = ["fmu", "build", "marine-craft", "--native", "--parameters", "hydrone"]
    assert seatrial(*build, cwd=tmp_path).returncode == 0
    rig = (harness / "rigs" / "hydrone-open-loop.toml").read_text("utf-8")
    python = '{ fmu = "marine-craft", parameters = "hydrone" }'
    assert python in rig
    native = '{ fmu = "marine-craft.fmu", parameters = "hydrone.marine-craft" }'
    (tmp_path / "rig.toml").write_text(rig.replace(python, native), "utf-8")
    trial = (harness / "trials" / "hydrone-open-landing.toml").read_text("utf-8")
    trial = trial.replace('"hydrone-open-loop"', '"rig.toml"')
    (tmp_path / "trial.toml").write_text(trial, "utf-8")
    records = []
    for name in ("trial.toml", "hydrone-open-landing"):
        out = f"run-{len(records)}"
        done = seatrial("run", name, "--out", out, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        records.append((tmp_path / out / "signals.csv").read_bytes())
    assert records[0].count(b"\n") > 2000
    assert records[0] == records[1]


class Spring(Plant):
    """Mass on a spring."""

    stiffness = Parameter(4.0, "N/m", "stiffness", min=0.5, max=100.0)
    drag = Parameter(0.0, "N.s/m", "drag", tunable=True, min=0.0)
    form = Parameter("linear", "1", "of the spring", choices=("linear", "cubic"))
    force = Input("N", "force")
    x = State("m", "place", start=1.0)
    v = State("m/s", "speed")

    def equations(self, x, u, p):
        pull = x.x if p.form == "linear" else x.x**3
        return {"x": x.v, "v": u.force - p.stiffness * pull - p.drag * x.v}, {}


@pytest.fixture
def spring(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Slave:
    return Slave(built(f"{__file__}:Spring", tmp_path), tmp_path)


@pytest.mark.slow
def test_closed_form_and_rollback(spring: Slave) -> None:
    """x = cos(2 t): a spring of 4 N/m with 1 kg, let go at 1 m."""
    spring.begin()
    x = spring.reference["x"]
    for k in range(100):
        spring.fmu.doStep(k * 0.01, 0.01)
    assert spring.fmu.getReal([x]) == [pytest.approx(math.cos(2.0), abs=1e-8)]
    state = spring.fmu.getFMUstate()
    saved = spring.fmu.serializeFMUstate(state)
    spring.fmu.doStep(1.0, 0.1)
    once = spring.fmu.getReal([x])
    spring.fmu.setFMUstate(spring.fmu.deSerializeFMUstate(saved))
    spring.fmu.doStep(1.0, 0.1)
    assert spring.fmu.getReal([x]) == once
    spring.fmu.reset()
    spring.begin()
    assert spring.fmu.getReal([x]) == [1.0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "value", "running", "message"),
    [
        ("stiffness", 0.1, False, "stiffness is 0.1 N/m, allowed 0.5 to 100.0 N/m"),
        ("stiffness", 5.0, True, "fixed parameter and cannot change"),
        ("drag", -1.0, True, "drag is -1.0 N.s/m, allowed at least 0.0 N.s/m"),
        ("x", 1.0, False, "is an output and cannot be set"),
        ("force", float("nan"), True, "is not a finite number"),
        ("form", "cubic", False, "'linear', built into this FMU, and cannot become 'cubic'"),
    ],
)
def test_what_does_not_fit_is_refused(name, value, running, message, spring: Slave) -> None:
    if running:
        spring.begin()
    reference = [spring.reference[name]]
    with pytest.raises(Exception, match=r"fmi2Set|fmi2Enter"):
        if isinstance(value, str):
            spring.fmu.setString(reference, [value])
        else:
            spring.fmu.setReal(reference, [value])
        spring.begin()
    assert message in spring.messages[0]


@pytest.mark.slow
def test_a_diverging_step_is_discarded(spring: Slave) -> None:
    spring.begin()
    spring.fmu.setReal([spring.reference["force"]], [1.7e308])
    with pytest.raises(Exception, match="fmi2DoStep"):
        for k in range(100):
            spring.fmu.doStep(float(k), 1.0)
    assert "output" in spring.messages[0]


@pytest.mark.slow
def test_numbers_that_a_start_needs_may_come_with_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A propeller without thrust is refused at the start, and 0 is the value that the FMU has.
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    source = find_source("fitted-craft", Path.cwd())
    propeller = {"propulsors": "propeller", "propulsor_K_T_1.k0": 0.4, "propulsor_K_Q_1.k0": 0.04}
    with pytest.raises(InputError, match="k0 of more than 0 is needed"):
        native_fmu(source, {"propulsors": "propeller"})
    assert zipfile.is_zipfile(native_fmu(source, propeller))


def test_what_cannot_be_native_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mavlink cannot be native: it reaches outside"):
        built("mavlink", tmp_path)
    with pytest.raises(InputError, match="still water and air"):
        built("marine-craft", tmp_path, {"current_speed": 1.0})
    with pytest.raises(InputError, match="definite"):
        built("marine-craft", tmp_path, {"added_coupling": [1e9] * 9})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bwrap") is None, reason="bubblewrap is not installed")
def test_a_host_without_python(tmp_path: Path) -> None:
    """A C program that sees the C library and the FMU, and no other file."""
    path = built("marine-craft", tmp_path)
    fmpy.extract(str(path), str(tmp_path / "image"))
    guid = fmpy.read_model_description(str(path)).guid
    library = tmp_path / "image" / "binaries" / "linux64" / "marine_craft.so"
    nm = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True)
    assert {line.split()[-1][:4] for line in nm.stdout.splitlines()} == {"fmi2"}
    host = tmp_path / "image" / "host"
    _compile([HOST], host, "-ldl")
    # The loader's folder is /lib64; the C library's depends on the system.
    needed = subprocess.run(["ldd", host], capture_output=True, text=True, check=True).stdout
    needed += subprocess.run(
        ["ldd", *(tmp_path / "image").rglob("*.so")], capture_output=True, text=True, check=True
    ).stdout
    libraries = {w for w in needed.split() if w.startswith("/")}
    bound = [a for each in sorted(libraries) for a in ("--ro-bind", each, each)]
    inside = ["bwrap", "--unshare-all", *bound, "--ro-bind", str(tmp_path / "image"), "/fmu"]
    run = subprocess.run(
        [*inside, "/fmu/host", "/fmu/binaries/linux64/marine_craft.so", guid],
        capture_output=True,
        text=True,
    )
    if "Operation not permitted" in run.stderr or "namespace" in run.stderr:
        pytest.skip("this system gives its users no namespaces")
    assert (run.returncode, run.stdout, run.stderr) == (0, "stepped to 1 s\n", "")


@pytest.mark.interop
@pytest.mark.parametrize(
    "name", [pytest.param("rov", marks=pytest.mark.long), "gnss", "thruster", "station-keeping"]
)
def test_sanitizers_find_nothing(name: str, tmp_path: Path) -> None:
    """The same sources with another compiler, its warnings and its checks at run time."""
    path = built(name, tmp_path)
    fmpy.extract(str(path), str(tmp_path / "fmu"))
    sources = tmp_path / "fmu" / "sources"
    own = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-std=c99"]
    for source in sources.glob("*.c"):
        if name != "rov" or source.stem != "model":  # which is CasADi's
            _compile([source], tmp_path / f"{source.stem}.o", "-c", *own)
    program = tmp_path / "checked"
    linked = ["-DLINKED", f"-I{sources}", "-fsanitize=address,undefined", "-fno-sanitize-recover"]
    _compile([HOST, *sources.glob("*.c")], program, "-Wall", "-Werror", *linked, "-lm")
    guid = fmpy.read_model_description(str(path)).guid
    run = subprocess.run([program, "", guid], capture_output=True, text=True)
    assert (run.returncode, run.stdout, run.stderr) == (0, "stepped to 1 s\n", "")


def _compile(sources: list[Path], to: Path, *flags: str) -> None:
    headers = Path(fmpy.__file__).parent / "c-code"
    command = ["cc", f"-I{headers}", *map(str, sources), "-o", str(to), *flags]
    subprocess.run(command, check=True)


@pytest.mark.long
def test_binaries_for_others(tmp_path: Path) -> None:
    """Formats by their own numbers: PE of x86-64, Mach-O of x86-64, ELF of AArch64."""
    platforms = ("linux64", "win64", "darwin64", "aarch64-linux")
    path = built(f"{__file__}:Spring", tmp_path, platforms=platforms)
    stem = find_source(f"{__file__}:Spring", Path.cwd()).stem
    with zipfile.ZipFile(path) as archive:
        windows = archive.read(f"binaries/win64/{stem}.dll")
        (header,) = struct.unpack_from("<I", windows, 0x3C)
        assert windows[header : header + 6] == b"PE\0\0" + struct.pack("<H", 0x8664)
        mac = archive.read(f"binaries/darwin64/{stem}.dylib")
        assert struct.unpack_from("<II", mac) == (0xFEEDFACF, 0x01000007)
        arm = archive.read(f"binaries/aarch64-linux/{stem}.so")
        assert arm[:5] == b"\x7fELF\x02"
        assert struct.unpack_from("<H", arm, 18) == (183,)
        for library in (windows, mac, arm, archive.read(f"binaries/linux64/{stem}.so")):
            assert b"fmi2DoStep" in library
    again = built(f"{__file__}:Spring", tmp_path / "again", platforms=platforms)
    assert again.read_bytes() == path.read_bytes()
