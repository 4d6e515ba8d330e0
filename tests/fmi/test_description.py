"""The model description against FMPy's checker and against what was declared."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import shipped_sources
from tests.kit import needs_kits

from .conftest import built_once, source

WAITING = ("ardupilot", "px4")
"""They step as their firmware does, and wait for that."""
NEEDED = {
    "ground-station": {"link": "udpin:127.0.0.1:0"},
    "marks": {"count": 1.0, "radius": 4.0},
}
"""Values of parameters without which one does nothing."""
SOME = ("canbus", "gnss", "mavlink", "sailboat", "station-keeping", "tether")
"""A link, a bus, a sensor, a controller, a hull and one with a step of its own."""


def test_declarations_arrive_exactly(counter_fmu: Path) -> None:
    assert validate_fmu(str(counter_fmu)) == []
    description = read_model_description(str(counter_fmu))
    variables = {v.name: v for v in description.modelVariables}
    assert variables["bias.b"].start == repr(1.0 / 3.0)
    assert float(variables["bias.b"].start) == 1.0 / 3.0
    assert variables["gain"].start == "0.1"
    u = variables["u"]
    assert (u.unit, u.min, u.max, u.nominal) == ("m", "-1000.0", "1000.0", "2.5")
    assert variables["label"].start == "plain"
    assert variables["knob"].variability == "tunable"
    assert variables["gain"].variability == "fixed"
    assert {v.variability for v in variables.values() if v.type != "Real"} <= {"fixed", "discrete"}
    (metre,) = [u for u in description.unitDefinitions if u.name == "m"]
    assert metre.baseUnit.m == 1
    simulation = description.coSimulation
    assert simulation.canGetAndSetFMUstate
    assert simulation.canSerializeFMUstate


@pytest.mark.slow
def test_each_axis_has_its_unit(tmp_path: Path) -> None:
    path = built_once(shipped_sources()["sailboat"], tmp_path / "sailboat.fmu")
    units = {v.name: v.unit for v in read_model_description(str(path)).modelVariables}
    assert [units[f"eta.{axis}"] for axis in ("x", "y", "phi", "psi")] == ["m", "m", "rad", "rad"]
    assert [units[f"sail_load.{axis}"] for axis in "XYKN"] == ["N", "N", "N.m", "N.m"]
    assert units["nu_start.r"] == "rad/s"


@needs_kits("can")
def test_a_port_may_have_no_unit(tmp_path: Path) -> None:
    path = built_once(shipped_sources()["can-signals"], tmp_path / "can-signals.fmu")
    assert validate_fmu(str(path)) == []
    units = {v.name: v.unit for v in read_model_description(str(path)).modelVariables}
    assert (units["send.s1"], units["received.s16"], units["lost_after"]) == (None, None, "1")


def test_dependencies_say_direct_feedthrough_only(counter_fmu: Path) -> None:
    description = read_model_description(str(counter_fmu))
    depends = {u.variable.name: [d.name for d in u.dependencies] for u in description.outputs}
    assert depends == {
        "total": [], "through": ["u"], "steps": [], "was_on": ["on"], "said": ["say"]
    }  # fmt: skip


def test_no_empty_unit_definitions_and_no_outputs(write, tmp_path: Path) -> None:
    file = write(
        "mute.py",
        "from seatrial.model.component import Component, Parameter\n\n\n"
        "class Mute(Component):\n"
        '    """Says nothing."""\n\n'
        '    text = Parameter("a<&b", "1", "t")\n',
    )
    path = build_fmu(source(file, "Mute"), tmp_path / "mute.fmu")
    assert validate_fmu(str(path)) == []
    assert read_model_description(str(path)).unitDefinitions == []


@pytest.mark.parametrize(
    ("declaration", "message"),
    [
        ('x = Output("furlong3.xyz", "d")', "'furlong3.xyz' is not a unit"),
        ('x = Output("m", "d", axes=("1",))', "axis '1' is not an identifier"),
        ('x = Parameter("a\\0b", "1", "d")', "cannot hold"),
    ],
)
def test_what_cannot_be_described_is_refused(
    declaration: str, message: str, write, tmp_path: Path
) -> None:
    file = write(
        "odd.py",
        "from seatrial.model.component import Component, Output, Parameter\n\n\n"
        f'class Odd(Component):\n    """Odd."""\n\n    {declaration}\n',
    )
    with pytest.raises(InputError, match=message):
        build_fmu(source(file, "Odd"), tmp_path / "odd.fmu")
    assert not (tmp_path / "odd.fmu").exists()


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in SOME else pytest.mark.interop)
        for name in shipped_sources()
        if name not in WAITING
    ],
)
def test_a_shipped_fmu_runs_alone_in_fmpy(name: str, tmp_path: Path) -> None:
    """FMPy finds no problem in it; with its defaults, or what it needs, nothing of ours drives it."""
    path = built_once(shipped_sources()[name], tmp_path / f"{name}.fmu")
    assert validate_fmu(str(path)) == []
    description = read_model_description(str(path))
    assert description.modelName == name
    result = simulate_fmu(
        str(path),
        validate=False,
        stop_time=0.5,
        output_interval=0.05,
        start_values=NEEDED.get(name, {}),
    )
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    assert len(result) == 11
    assert result["time"][-1] == pytest.approx(0.5)
    for output in outputs:
        if output in result.dtype.names:  # FMPy records no text
            assert np.isfinite(result[output]).all()
