"""The tolerance of a component, a rig or a default experiment, as FMUs are given it."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from ..fmi.models import build_model_fmu
from ..fmi.native import build_native_fmu, changed, variant

NONE = -1.0
EXPERIMENT = (
    "<ModelVariables>",
    '<DefaultExperiment stopTime="1" tolerance="3e-5"/><ModelVariables>',
)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tolerance")
    for name in ("fmi2", "fmi3"):
        plain = build_native_fmu(name, folder)
        shows = variant(plain, folder / f"shows-{name}.fmu", "SHOWS_TOLERANCE")
        changed(shows, folder / f"says-{name}.fmu", EXPERIMENT)
    build_model_fmu(1, folder, "co-simulation")
    return folder


def tolerances(path: Path, text: str) -> dict[str, float]:
    """Return the tolerance that each component was given, `NONE` where none was defined."""
    path.write_text(text)
    system = assemble(load_rig(str(path)))
    try:
        master = Master(system)
        master.initialise()
        return {part: master.values(part, ["x"])[0] for part in system.parts}
    finally:
        system.free()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fmi2", "fmi3"])
def test_the_nearest_counts(fmus: Path, name: str) -> None:
    components = f"""
own = {{ fmu = "says-{name}.fmu", tolerance = 1e-3 }}
said = {{ fmu = "says-{name}.fmu" }}
apart = {{ fmu = "says-{name}.fmu", tolerance = 1e-3, isolated = true }}
none = {{ fmu = "shows-{name}.fmu" }}
"""
    step = 'step = "10 ms"\n'
    path = fmus / f"{name}.toml"
    own = {"own": 1e-3, "apart": 1e-3}
    found = tolerances(path, f"{step}[components]{components}")
    assert found == {**own, "said": 3e-5, "none": NONE}
    found = tolerances(path, f"{step}tolerance = 1e-4\n[components]{components}")
    assert found == {**own, "said": 1e-4, "none": 1e-4}


def test_a_rig_inside_has_its_own_or_that_around(fmus: Path) -> None:
    for name, own in (("plain", ""), ("fine", "tolerance = 1e-6\n")):
        (fmus / f"{name}.toml").write_text(
            f'step = "10 ms"\n{own}[components]\na = {{ fmu = "shows-fmi2.fmu" }}\n'
        )
    text = 'step = "10 ms"\ntolerance = 1e-4\n[components]\n'
    text += 'plain = { rig = "plain.toml" }\nfine = { rig = "fine.toml" }\n'
    assert tolerances(fmus / "outer.toml", text) == {"plain.a": 1e-4, "fine.a": 1e-6}


def test_fmi_1_takes_none_in_co_simulation(fmus: Path) -> None:
    one = 'step = "10 ms"\n{0}[components]\na = {{ fmu = "model1cs.fmu"{1} }}\n'
    (fmus / "one.toml").write_text(one.format("tolerance = 1e-4\n", ""))
    assemble(load_rig(str(fmus / "one.toml"))).free()
    (fmus / "one.toml").write_text(one.format("", ", tolerance = 1e-4"))
    with pytest.raises(
        InputError, match=r"components\.a.*co-simulation of FMI 1.0 has no tolerance"
    ):
        assemble(load_rig(str(fmus / "one.toml")))


@pytest.mark.parametrize("written", ["0", "-1e-3", "0.2", "nan", '"fine"'])
def test_what_is_no_tolerance_is_refused(fmus: Path, written: str) -> None:
    path = fmus / "wrong.toml"
    path.write_text(
        f'step = "10 ms"\ntolerance = {written}\n[components]\na = {{ fmu = "fmi2.fmu" }}\n'
    )
    with pytest.raises(InputError, match="tolerance"):
        load_rig(str(path))
