"""FMI 1.0 FMUs of others in co-simulation: closed form, types, aliases, messages, refusals."""

from __future__ import annotations

import logging
import math
import zipfile
from pathlib import Path

import fmpy
import pytest

from seatrial import Simulation
from seatrial.errors import InputError, SimulationError
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

from .models import build_model_fmu
from .native import changed, read, started


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    return build_model_fmu(1, tmp_path_factory.mktemp("fmi1"), "co-simulation")


@pytest.fixture
def fmi1(path: Path):
    """Return a function that makes a started instance with start values."""
    opened = []

    def start(**values):
        opened.append(open_instance(load_fmu(path), "boat"))
        return started(opened[-1], **values)

    yield start
    for instance in opened:
        instance.free()


def test_decay_is_exact_and_equal_to_fmpys_own_simulation(fmi1, path: Path) -> None:
    result = fmpy.simulate_fmu(
        str(path), stop_time=1.0, output_interval=0.1, start_values={"k": 1.3}, output=["x"]
    )
    instance = fmi1(k=1.3)
    own = read(instance, "x")
    for step in range(10):
        instance.step(step * 0.1, 0.1)
        own += read(instance, "x")
    assert own == pytest.approx(list(result["x"]), rel=1e-12)
    assert own[-1] == pytest.approx(math.exp(-1.3), rel=1e-12)
    instance.terminate()


def test_types_aliases_and_dependencies(fmi1, path: Path) -> None:
    fmu = load_fmu(path)
    assert fmu.variables["k"].causality == "parameter"
    assert fmu.feedthrough["y"] == ["u"]
    assert "x" not in fmu.feedthrough
    assert fmu.feedthrough["steps"] == ["u", "flag", "text"]  # it says nothing of them
    assert fmu.any_step
    assert not fmu.rolls_back
    instance = fmi1(flag=True)
    assert read(instance, "text") == ["application/x-fmu-sharedlibrary"]
    instance.writer(["text", "u"])(["água", 3.0])
    assert read(instance, "flag", "not_flag", "echo", "y") == [True, False, "água", 6.0]
    instance.step(0.0, 0.5)
    x, minus_x = read(instance, "x", "minus_x")
    assert minus_x == -x == pytest.approx(-math.exp(-0.5))
    assert read(instance, "steps", "relay") == [2, 1]


RIG = """
step = "0.1 s"

[components]
b = {{ fmu = "{fmi1}"{isolated} }}
a = {{ fmu = "{fmi1}" }}
source = {{ fmu = "{fmi2}", set = {{ k = 0.5 }}, interface = "co-simulation" }}

[connections]
"a.y" = "b.u"
"source.x" = {{ to = "a.u", factor = {factor} }}
"""


@pytest.mark.parametrize(("factor", "relays"), [(0.2, [0, 0]), (0.4, [0, 1]), (0.6, [1, 1])])
@pytest.mark.parametrize("interface", ["co-simulation", "model exchange"])
def test_inputs_have_the_values_of_others_in_the_initialisation(
    path: Path, write, interface: str, factor: float, relays: list[int]
) -> None:
    """``relay`` says if u was above 0.5 there; y is 2 u. The source is 1 at the start."""
    fmi1 = path if interface == "co-simulation" else build_model_fmu(1, path.parent)
    fmi2 = build_model_fmu(2, path.parent)
    rig = write("r.toml", RIG.format(fmi1=fmi1, fmi2=fmi2, factor=factor, isolated=""))
    with Simulation(rig, engine="fmu") as simulation:
        assert [simulation.get("a.relay"), simulation.get("b.relay")] == relays


def test_they_have_them_in_a_process_of_its_own(path: Path, write) -> None:
    fmi2 = build_model_fmu(2, path.parent)
    isolated = ", isolated = true"
    rig = write("r.toml", RIG.format(fmi1=path, fmi2=fmi2, factor=0.4, isolated=isolated))
    with Simulation(rig, engine="fmu") as simulation:
        assert [simulation.get("a.relay"), simulation.get("b.relay")] == [0, 1]


def test_a_loop_of_fmi_1_begins_with_the_first_one(path: Path, write) -> None:
    """What feeds it is 0 then; the other one has then its x, which is 1."""
    text = """
    step = "0.1 s"
    [components]
    a = {{ fmu = "{fmi1}" }}
    b = {{ fmu = "{fmi1}" }}
    [connections]
    "a.x" = "b.u"
    "b.x" = {{ to = "a.u", factor = 0.25 }}
    """
    with Simulation(write("r.toml", text.format(fmi1=path)), engine="fmu") as simulation:
        assert [simulation.get("a.relay"), simulation.get("b.relay")] == [0, 1]


def test_errors_and_warnings_carry_what_the_fmu_says(fmi1, path: Path, caplog) -> None:
    with pytest.raises(SimulationError, match="boat: fmiInitializeSlave returned error: k is neg"):
        fmi1(k=-1.0)
    with pytest.raises(SimulationError, match=r"boat: fmiDoStep\(t = 0.0 .* error: no step"):
        fmi1(trouble=1.0).step(0.0, 0.1)
    with caplog.at_level(logging.WARNING, "seatrial.fmu.boat"):
        fmi1(trouble=3.0).step(0.0, 0.1)
    assert "such a step" in caplog.text


def test_an_instance_that_cannot_be_made(path: Path, tmp_path: Path) -> None:
    other = changed(path, tmp_path / "x.fmu", ("{model}", "{other}"))
    with pytest.raises(SimulationError, match=r"x\.fmu could not be instantiated: another guid"):
        open_instance(load_fmu(other), "boat")


def test_isolated_it_gives_the_same(fmi1, path: Path) -> None:
    plain, isolated = fmi1(k=0.7), IsolatedInstance(load_fmu(path), "boat", 60.0)
    try:
        started(isolated, k=0.7)
        for step in range(5):
            for instance in (plain, isolated):
                instance.step(step * 0.1, 0.1)
        names = ("x", "minus_x", "steps", "echo", "not_flag")
        assert read(isolated, *names) == read(plain, *names)
        assert not isolated.rolls_back
    finally:
        isolated.free()


def test_platforms_that_it_has_are_named(path: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(other, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
        new.writestr("binaries/win64/model.dll", b"MZ")
        new.writestr("binaries/darwin64/model.dylib", b"x")
    with pytest.raises(
        InputError,
        match=rf"other\.fmu: cannot be loaded on this machine, which needs binaries for "
        rf"{fmpy.platform}, or sources; the FMU has binaries for darwin64, win64",
    ):
        open_instance(load_fmu(other), "boat")


def test_tools_that_repeat_names_of_local_variables(path: Path, tmp_path: Path) -> None:
    double = changed(path, tmp_path / "x.fmu", ('name="fall"', 'name="dx"'))
    fmu = load_fmu(double)
    assert "dx" not in fmu.variables
    assert fmu.notes == ("local variables that share a name with another are left out: dx",)


def test_a_tool_is_called_by_its_type(path: Path, tmp_path: Path) -> None:
    model = '<CoSimulation_Tool><Model entryPoint="fmu://x.m" type="application/x-mytool"/></CoSimulation_Tool>'
    tool = changed(
        path,
        tmp_path / "x.fmu",
        ("<Implementation>", f"<Implementation>{model}"),
    )
    instance = open_instance(load_fmu(tool), "boat")
    assert read(instance, "text") == ["application/x-mytool"]
    instance.free()
