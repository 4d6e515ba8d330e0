"""A rig as one FMU: the numbers of the rig, its states, what it refuses, hosts, rigs around it."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.validation import validate_fmu

import seatrial.sim.master
from seatrial import Simulation
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.interchange.rig_fmu.native import build_native_rig, why_not_native
from seatrial_kits.native.engine import carry_natively
from tests.bwrap import needs_bwrap
from tests.command import seatrial as command
from tests.fmi.native_slave import Slave
from tests.kits.native.test_standalone import RESOURCES, image_of

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

HOSTS = Path(__file__).parents[2] / "interop" / "native_host_run.py"
SHIPPED = (
    *("landing", "deck-landing", "deck-limits", "collision", "hydrone-battery", "mariner-source"),
    *("hydrone-open-loop", "gloria-fixed", "thruster-ship", "thruster-ship-open-loop"),
    *("videoray-hold", "videoray-excitation", "videoray-surface", "videoray-surface-nominal"),
    *("gloria", "gloria-heading", "mariner", "mariner-pd", "mariner-rudder"),
)
"""Shipped rigs, beside `sil`, whose components all have C."""

TEXT = '''
"""A mass on a spring, a sampled controller, and a gain without a state."""

from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.plant import Plant, State
from seatrial.model.sampled import Sampled


class Mass(Plant):
    """Mass on a spring."""

    stiffness = Parameter(4.0, "N/m", "stiffness", min=0.5, max=100.0)
    drag = Parameter(0.1, "N.s/m", "drag", tunable=True, min=0.0)
    force = Input("N", "force")
    push = Input("N", "force from outside")
    x = State("m", "place", start=1.0)
    v = State("m/s", "speed")
    feedthrough = {"pull": ("push",)}
    pull = Output("N", "force that is felt")

    def equations(self, x, u, p):
        a = u.force + u.push - p.stiffness * x.x - p.drag * x.v
        return {"x": x.v, "v": a}, {"pull": u.push - p.stiffness * x.x}


class Gain(Component):
    """Multiplies."""

    factor = Parameter(0.5, "1", "factor", tunable=True)
    u = Input("N", "signal")
    w = Input("N", "another signal")
    y = Output("N", "factor times the sum of both")
    feedthrough = {"y": ("u", "w")}

    def outputs(self, t):
        self.y = self.factor * (self.u + self.w)


class Hold(Sampled):
    """Steers towards a place."""

    place = Input("m", "where it is")
    wanted = Input("m", "where it should be")
    share = Parameter(2.0, "N/m", "gain", tunable=True)
    force = Output("N", "force")
    feedthrough = {"force": ("place", "wanted")}

    def reset(self, t):
        self._sum = 0.0

    def sample(self, t, k):
        self.force = self.share * (self.wanted - self.place) + self._sum

    def update(self, t, k):
        self._sum += 0.01 * (self.wanted - self.place)
'''

RIG = """
step      = "10 ms"
algorithm = "{algorithm}"

[components]
mass  = {{ fmu = "bodies.py:Mass", set = {{ x_start = 0.7 }} }}
hold  = {{ fmu = "bodies.py:Hold", step = "30 ms", set = {{ period = "30 ms" }} }}
first = {{ fmu = "bodies.py:Gain" }}
other = {{ fmu = "bodies.py:Gain", set = {{ factor = 0.25 }} }}

[connections]
"mass.x"     = "hold.place"
"hold.force" = {{ to = "mass.force", factor = 0.9, offset = 0.05 }}
"mass.pull"  = "first.u"
"first.y"    = "other.u"
"other.y"    = "first.w"

[shows]
wrench = {{ force = "mass.push" }}
motion = {{ position = "mass.x" }}
"""


def built(rig: Path, folder: Path) -> Path:
    """Build the FMU of a rig by this machine's compiler."""
    system = assemble(load_rig(str(rig)), "native")
    try:
        assert why_not_native(system, carry_natively(system)) == []
        return build_native_rig(system, folder / f"{rig.stem}.fmu", (HERE,), library_here)
    finally:
        system.free()


def bits(values: list[Any]) -> list[bytes]:
    return [struct.pack("d", float(value)) for value in values]


class Box(Slave):
    """A rig's FMU in FMPy."""

    def outputs(self) -> dict[str, float]:
        found = {}
        for kind in ("Real", "Integer", "Boolean"):
            of_kind = [
                v
                for v in self.description.modelVariables
                if v.causality == "output" and v.type == kind
            ]
            get = getattr(self.fmu, f"get{kind}")
            references = [v.valueReference for v in of_kind]
            found |= zip([v.name for v in of_kind], get(references), strict=True)
        return found

    def set(self, name: str, value: float) -> None:
        self.fmu.setReal([self.reference[name]], [value])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rigs")
    (folder / "bodies.py").write_text(TEXT, "utf-8")
    for algorithm in ("jacobi", "gauss-seidel", "extrapolated", "plain-jacobi"):
        text = RIG.format(algorithm=algorithm)
        (folder / f"{algorithm.replace('-', '_')}.toml").write_text(text, "utf-8")
    return folder


@pytest.fixture(scope="module")
def jacobi(folder: Path) -> Path:
    return built(folder / "jacobi.toml", folder)


@pytest.fixture
def box(jacobi: Path, tmp_path: Path) -> Iterator[Box]:
    box = Box(jacobi, tmp_path)
    yield box
    box.fmu.freeInstance()


def agree(box: Box, simulation: Simulation) -> None:
    found = box.outputs()
    assert bits(list(found.values())) == bits([simulation.get(name) for name in found])


def runs_alike(path: Path, rig: Path, folder: Path) -> None:
    """Loop, conversions, a component with a longer step; inputs and parameters set on the way."""
    assert validate_fmu(str(path)) == []
    box = Box(path, folder)
    box.begin()
    with Simulation(rig) as simulation:
        agree(box, simulation)
        k = 0
        while k < 90:
            if k == 31:
                box.set("hold.wanted", 0.4)
                simulation.set("hold.wanted", 0.4)
            if k == 50:
                box.set("mass.drag", 0.8)
                simulation.set("mass.drag", 0.8)
                agree(box, simulation)
            count = 1 + k % 3
            box.fmu.doStep(k * 0.01, count * 0.01)
            simulation.step(count)
            k += count
            agree(box, simulation)
    assert box.messages == []
    box.fmu.terminate()
    box.fmu.freeInstance()


@pytest.mark.slow
def test_the_numbers_of_the_rig(jacobi: Path, folder: Path, tmp_path: Path) -> None:
    runs_alike(jacobi, folder / "jacobi.toml", tmp_path)


@pytest.mark.interop
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "extrapolated", "plain_jacobi"])
def test_by_other_algorithms(algorithm: str, folder: Path, tmp_path: Path) -> None:
    rig = folder / f"{algorithm}.toml"
    runs_alike(built(rig, tmp_path), rig, tmp_path)


def test_values_before_the_run(box: Box, folder: Path) -> None:
    box.set("mass.x_start", 0.2)
    box.fmu.setupExperiment(startTime=0.0)
    box.fmu.enterInitializationMode()
    box.set("mass.stiffness", 9.0)
    box.set("first.factor", 0.125)
    assert box.outputs()["mass.pull"] == -9.0 * 0.2
    box.fmu.exitInitializationMode()
    values = {"mass.x_start": 0.2, "mass.stiffness": 9.0, "first.factor": 0.125}
    with Simulation(folder / "jacobi.toml", set=values) as simulation:
        for k in range(10):
            agree(box, simulation)
            box.fmu.doStep(k * 0.01, 0.01)
            simulation.step()
    box.fmu.reset()
    box.begin()
    assert box.outputs()["mass.x"] == 0.7


def test_rollback(box: Box) -> None:
    box.begin()
    for k in range(20):
        box.fmu.doStep(k * 0.01, 0.01)
    saved, before = box.serialized(), box.outputs()
    box.set("hold.wanted", 0.3)
    box.fmu.doStep(0.2, 0.25)
    once = box.outputs()
    assert once != before
    box.restore(saved)
    assert box.outputs() == before
    box.set("hold.wanted", 0.3)
    for k in range(25):
        box.fmu.doStep(0.2 + k * 0.01, 0.01)
    assert bits(list(box.outputs().values())) == bits(list(once.values()))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("mass.stiffness", 5.0, "stiffness is a fixed parameter and cannot change"),
        ("mass.drag", -1.0, "x.mass.drag is -1.0 N.s/m, allowed at least 0.0 N.s/m"),
        ("mass.x", 1.0, "mass.x is an output and cannot be set"),
    ],
)
def test_what_does_not_fit_is_refused(name: str, value: float, message: str, box: Box) -> None:
    box.begin()
    with pytest.raises(Exception, match="fmi2SetReal"):
        box.set(name, value)
    assert message in box.messages[0]


def test_a_step_that_is_no_multiple_is_refused(box: Box) -> None:
    box.begin()
    with pytest.raises(Exception, match="fmi2DoStep"):
        box.fmu.doStep(0.0, 0.015)
    assert box.messages == ["x: a step of 0.015 s is no whole multiple of this rig's, 0.01 s"]
    box.fmu.doStep(0.0, 0.1 - 0.08)  # which is not 0.02 to the bit


def test_a_value_that_is_too_large_ends_it(box: Box) -> None:
    box.begin()
    box.set("mass.push", 1.7e308)
    with pytest.raises(Exception, match="fmi2DoStep"):
        for k in range(5):
            box.fmu.doStep(k * 0.01, 0.01)
    assert "mass" in box.messages[0]


def test_variables_and_terminals(jacobi: Path) -> None:
    description = fmpy.read_model_description(str(jacobi))
    variables = {v.name: v for v in description.modelVariables}
    assert "hold.place" not in variables  # a connection feeds it
    assert (variables["mass.x_start"].start, variables["mass.x_start"].unit) == ("0.7", "m")
    assert variables["mass.drag"].variability == "tunable"
    assert variables["mass.drag"].min == "0.0"
    through = {u.variable.name: {d.name for d in u.dependencies} for u in description.outputs}
    assert through["other.y"] == {"mass.push", "other.w"}  # along mass.pull and first.y
    assert through["mass.x"] == set()
    assert description.defaultExperiment.stepSize == "0.01"
    done = command("fmu", "describe", str(jacobi), cwd=jacobi.parent)
    assert "wrench" in done.stdout
    assert "mass.push" in done.stdout


def test_in_a_rig_around_it(jacobi: Path, folder: Path, tmp_path: Path) -> None:
    """Its output drives another component, which drives its input: as if it were no FMU."""
    shutil.copy(folder / "bodies.py", tmp_path)
    shutil.copy(jacobi, tmp_path / "box.fmu")
    inner = f'{(folder / "jacobi.toml").read_text("utf-8")}wanted = "hold.wanted"\n'
    (tmp_path / "inner.toml").write_text(inner, "utf-8")
    around = """
step = "10 ms"
[components]
box  = { BOX, set = { "mass.drag" = 0.3 } }
more = { fmu = "bodies.py:Gain" }
[connections]
"box.motion.position" = { to = "more.u", convert = false }
"more.y" = { to = "WANTED", convert = false }
"""
    found = []
    for box, wanted in (
        ('fmu = "box.fmu"', "box.hold.wanted"),
        ('rig = "inner.toml"', "box.wanted"),
    ):
        text = around.replace("BOX", box).replace("WANTED", wanted)
        (tmp_path / "around.toml").write_text(text, "utf-8")
        with Simulation(tmp_path / "around.toml", engine="native") as simulation:
            simulation.step(60)
            found.append([simulation.get(name) for name in ("box.mass.x", "more.y")])
    assert bits(found[0]) == bits(found[1])


@pytest.fixture(scope="module")
def hydrone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The closed loop of the Hydrone, built as users build it."""
    pytest.importorskip("ziglang")
    folder = tmp_path_factory.mktemp("hydrone")
    run = command("fmu", "build", "--rig", "sil", cwd=folder)
    assert run.returncode == 0, run.stderr
    assert "in C: 12 components" in run.stdout
    return folder / "sil.fmu"


@pytest.mark.long
@pytest.mark.interop
def test_the_closed_loop_of_a_vehicle(hydrone: Path, tmp_path: Path) -> None:
    """GNSS with noise and delay, a fault by its text: the numbers of the rig in Python."""
    assert validate_fmu(str(hydrone)) == []
    checked = command("fmu", "check", str(hydrone), cwd=tmp_path)
    assert "no problem found" in checked.stdout
    box = Box(hydrone, tmp_path)
    box.begin()
    with Simulation("sil", engine="direct") as simulation:
        for k in range(300):
            agree(box, simulation)
            if k == 150:
                fault = "bias of=heading value=0.2 at=1.5 grows_over=1"
                box.fmu.setString([box.reference["vehicle.compass.fault"]], [fault])
                simulation.inject("bias", "vehicle.compass", of="heading", value=0.2, grows_over=1)
            box.fmu.doStep(k * 0.01, 0.01)
            simulation.step()
    box.fmu.freeInstance()


@pytest.mark.interop
@pytest.mark.parametrize("host", ["libcosim", "ecos", "fmucontainer"])
def test_in_hosts_of_others(host: str, hydrone: Path, tmp_path: Path) -> None:
    """A fault on the way: the numbers of the rig in Python."""
    box = shutil.copy(hydrone, tmp_path)
    variables = {v.name: v for v in fmpy.read_model_description(str(box)).modelVariables}
    words = {"Real": "float", "Integer": "int", "Boolean": "bool", "String": "str"}
    outputs = [v for v in variables.values() if v.causality == "output"]
    fault = variables["vehicle.gnss.fault"]
    job = {
        "step": 0.01,
        "steps": 100,
        "slaves": [
            {
                "name": "box",
                "path": str(box),
                "changes": [[40, "str", fault.name, fault.valueReference, "off"]],
                "outputs": [[words[v.type], v.name, v.valueReference] for v in outputs],
            }
        ],
    }
    # ecos needs the library of the package tbb, which lies in the environment's lib.
    libraries = {"LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"), "TMPDIR": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, HOSTS, host],
        input=json.dumps(job), capture_output=True, text=True, env=os.environ | libraries,
        cwd=tmp_path,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])["box"]
    with Simulation("sil", engine="direct") as simulation:
        for k, row in enumerate(found):
            if k == 40:
                simulation.inject("off", "vehicle.gnss")
            simulation.step()
            assert bits(row) == bits([simulation.get(v.name) for v in outputs])
    assert len(found) == 100


@pytest.mark.interop
def test_fmi_3(folder: Path, tmp_path: Path) -> None:
    """The same rig in front of FMI 3.0: arrays, and the numbers of the rig."""
    system = assemble(load_rig(str(folder / "jacobi.toml")), "native")
    try:
        carry_natively(system)
        path = tmp_path / "box.fmu"
        build_native_rig(system, path, (HERE,), library_here, version=3)
    finally:
        system.free()
    assert validate_fmu(str(path)) == []
    box = open_instance(load_fmu(path), "box")
    box.set_start({"mass.x_start": 0.4})
    box.initialise(0.0, 10.0)
    box.begin()
    names = ["mass.x", "mass.pull", "hold.force", "other.y"]
    read, write = box.reader(names), box.writer(["hold.wanted"])
    with Simulation(folder / "jacobi.toml", set={"mass.x_start": 0.4}) as simulation:
        for k in range(40):
            if k == 20:
                write([0.25])
                simulation.set("hold.wanted", 0.25)
            assert bits(read()) == bits([simulation.get(name) for name in names])
            box.step(k * 0.01, 0.01)
            simulation.step()
    box.terminate()
    box.free()


@pytest.mark.interop
@needs_bwrap
def test_a_host_without_python(hydrone: Path, tmp_path: Path) -> None:
    """A C program that sees glibc, the FMU and no other file; the FMU shows FMI's functions."""
    host, guid = image_of(hydrone, tmp_path)
    run = subprocess.run([*host, guid, RESOURCES, "1"], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
    library = next((tmp_path / "image").rglob("*.so"))
    nm = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True)
    assert {line.split()[-1][:4] for line in nm.stdout.splitlines()} == {"fmi2"}


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "choices"),
    [
        *((name, {}) for name in SHIPPED),
        *(("sil", {"vehicle": name}) for name in ("bluerov2", "mariner", "otter", "videoray")),
    ],
)
def test_shipped_rigs(rig: str, choices: dict[str, str], tmp_path: Path) -> None:
    chosen = [f"--choose={name}={value}" for name, value in choices.items()]
    run = command("fmu", "build", "--rig", rig, *chosen, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    box = Box(next(tmp_path.glob("*.fmu")), tmp_path)
    box.begin()
    with Simulation(rig, choices=choices) as simulation:
        h = simulation.step_size
        for k in range(500):
            agree(box, simulation)
            box.fmu.doStep(k * h, h)
            simulation.step()
    box.fmu.freeInstance()


@pytest.mark.long
@pytest.mark.parametrize("rig", ["sil", *SHIPPED])
def test_both_masters(rig: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shipped rigs whose components all have C: the same bits under the master in C and in Python."""
    with Simulation(rig, engine="native") as compiled:
        monkeypatch.setattr(seatrial.sim.master, "is_compiled", lambda _system: False)
        with Simulation(rig, engine="native") as python:
            names = [n for n, s in compiled.signals.items() if s.type is not str]
            for _ in range(100):
                compiled.step()
                python.step()
                found = [[one.get(name) for name in names] for one in (compiled, python)]
                assert bits(found[0]) == bits(found[1])


STIFFENING = '''
"""A loop whose gain grows beyond one as time goes on."""

from seatrial.model.component import Component, Input, Output


class Stiffening(Component):
    """Pulls back, more and more."""

    u = Input("N", "signal")
    y = Output("N", "what is left")
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = 1.0 - (0.8 + t) * self.u
'''


@pytest.fixture(scope="module")
def stiffening(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("loop")
    (folder / "stiffening.py").write_text(STIFFENING, "utf-8")
    rig = 'step = "10 ms"\n[components]\na = { fmu = "stiffening.py:Stiffening" }\n'
    (folder / "loop.toml").write_text(f'{rig}[connections]\n"a.y" = "a.u"\n', "utf-8")
    return folder / "loop.toml"


def test_a_loop_that_needs_relaxation_on_the_way(stiffening: Path) -> None:
    """y = 1 / (1.8 + t): plain iteration settles until 0.2 s; the compiled master goes on too."""
    with Simulation(stiffening, engine="native") as one, Simulation(stiffening) as other:
        for _ in range(100):
            one.step()
            other.step()
            assert bits([one.get("a.y")]) == bits([other.get("a.y")])
        assert one.get("a.y") == pytest.approx(1.0 / 2.8, abs=1e-10)


@pytest.mark.interop
def test_a_loop_in_one_fmu(stiffening: Path, tmp_path: Path) -> None:
    box = Box(built(stiffening, tmp_path), tmp_path)
    box.begin()
    with Simulation(stiffening) as simulation:
        for k in range(100):
            agree(box, simulation)
            box.fmu.doStep(k * 0.01, 0.01)
            simulation.step()
    box.fmu.freeInstance()


@pytest.mark.slow
def test_sums(folder: Path, tmp_path: Path) -> None:
    """A number and a vector, fed from inside and from outside; a state restored."""
    text = RIG.format(algorithm="plain-jacobi").partition('"mass.pull"')[0]
    text = text.replace(
        "[connections]",
        "total = { sum = { inputs = 3 } }\nboth = { sum = { inputs = 2, dimension = 2 } }\n"
        "[connections]",
    )
    text += """
"mass.pull"   = ["total.in[0]", "both.in[0][1]"]
"other.y"     = "total.in[1]"
"total.out"   = ["first.u", "both.in[1][1]"]
"first.y"     = ["other.u", "both.in[0][0]"]
"both.out[1]" = "first.w"
"""
    rig = folder / "sums.toml"
    rig.write_text(text, "utf-8")
    box = Box(built(rig, tmp_path), tmp_path)
    box.begin()
    with Simulation(rig) as simulation:
        for k in range(40):
            if k == 11:
                box.set("total.in[2]", 0.3)
                simulation.set("total.in[2]", 0.3)
            agree(box, simulation)
            if k == 20:
                saved, before = box.serialized(), box.outputs()
            box.fmu.doStep(k * 0.01, 0.01)
            simulation.step()
        agree(box, simulation)
        box.restore(saved)
        assert box.outputs() == before
    box.fmu.freeInstance()


def test_what_cannot_be_one(tmp_path: Path) -> None:
    run = command("fmu", "build", "--rig", "tether-towed", "--native", cwd=tmp_path)
    assert run.returncode == 2
    assert "tether-towed cannot be one FMU in C; tether: " in run.stderr
    run = command("fmu", "build", "--rig", "nothing-at-all", cwd=tmp_path)
    assert run.returncode == 2
    assert "nothing-at-all" in run.stderr
    for of_rig in (("--vehicle", "gloria"), ("--seed", "1")):
        run = command("fmu", "build", "gnss", *of_rig, cwd=tmp_path)
        assert "are of --rig" in run.stderr
    carried = ("--standalone", "--platforms", "win64")
    run = command("fmu", "build", "--rig", "landing", *carried, cwd=tmp_path)
    assert "--standalone FMUs are for Linux on x86-64 alone" in run.stderr
    assert list(tmp_path.iterdir()) == []
