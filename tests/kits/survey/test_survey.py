"""``seatrial fmu survey``: our Python FMUs and FMUs in C, against FMPy's runs of them."""

from __future__ import annotations

import json
import math
import re
import shutil
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer

from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import named_sources
from seatrial_kits.survey import surveying
from seatrial_kits.survey.command import survey_folder
from seatrial_kits.survey.surveying import Surveyed, fmus_in, survey
from seatrial_kits.survey.ways import WAYS
from tests.command import seatrial
from tests.fmi.models import build_model_fmu
from tests.fmi.native import changed, dying, without_events

TIMEOUT_S = 120.0
EVERY = ("in Python", "in C", "isolated", "FMPy")


def surveyed(folder: Path) -> dict[str, Surveyed]:
    return {one.path.stem: one for one in survey(fmus_in(folder), TIMEOUT_S)}


@pytest.mark.slow
def test_our_fmus_agree_with_fmpy(tmp_path: Path) -> None:
    build_fmu(named_sources()["servo"], tmp_path / "python2.fmu")
    build_fmu(named_sources()["gnss"], tmp_path / "python3.fmu", version=3, platforms=["linux64"])
    found = surveyed(tmp_path)
    assert {name: one.status for name, one in found.items()} == dict.fromkeys(found, "agrees")
    for one in found.values():
        assert one.outputs
        assert {"in Python", "isolated", "FMPy"} <= set(one.ways)
        assert all(apart.value == 0.0 for apart in one.differences.values()), one


@pytest.mark.slow
def test_models_in_c_agree_with_fmpy(tmp_path: Path) -> None:
    (tmp_path / "it").mkdir()
    for version, interface in ((1, "co-simulation"), (1, "model exchange"), (2, ""), (3, "")):
        path = build_model_fmu(version, tmp_path, interface or "model exchange")
        shutil.copyfile(path, tmp_path / "it" / path.name)
    found = surveyed(tmp_path / "it")
    # FMPy knows no event indicators but those that the description lists, which FMI 3.0 leaves
    # to the FMU: the ball falls through the floor there.
    assert found.pop("model3").differing.keys() == {"in Python", "isolated"}
    assert {name: one.status for name, one in found.items()} == dict.fromkeys(found, "agrees")


@pytest.mark.slow
def test_slaves_in_c_agree_with_fmpy(native_fmu: Callable[[str], Path], tmp_path: Path) -> None:
    for name in ("fmi2", "fmi3"):
        shutil.copyfile(native_fmu(name), tmp_path / f"{name}.fmu")
    without_events(native_fmu("fmi3"), tmp_path / "promises.fmu")
    found = surveyed(tmp_path)
    assert {name: one.status for name, one in found.items()} == dict.fromkeys(found, "agrees")


@pytest.mark.slow
def test_fmus_that_cannot_be_are_lines_with_the_reason(
    native_fmu: Callable[[str], Path], tmp_path: Path
) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "text.fmu").write_text("no archive")
    shutil.copyfile(native_fmu("fmi2"), tmp_path / "good.fmu")
    dying(native_fmu("fmi3"), tmp_path / "dies.fmu", "AT_THE_END")
    done = seatrial("fmu", "survey", str(tmp_path), "--json", cwd=tmp_path)
    assert done.returncode == 1
    result: dict[str, Any] = {one["fmu"]: one for one in json.loads(done.stdout)["result"]["fmus"]}
    assert [one["status"] for one in result.values()] == ["fails", "agrees", "not loaded"]
    assert "not an FMU" in result["inner/text.fmu"]["unfit"]
    assert "SIG" in result["dies.fmu"]["problems"]["in Python"]
    assert result["good.fmu"]["differences"]["in C"]["relative"] == 0.0


@pytest.mark.slow
def test_a_difference_is_named_and_decides_the_status(
    native_fmu: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def late(fmu: Any, experiment: Any) -> Any:
        rows = dict(WAYS["in Python"](fmu, experiment))
        name = next(iter(rows))
        values = [float(value) for value in rows[name]]
        values[3] += 1e-6 * max(map(abs, values))
        return {**rows, name: values}

    shutil.copyfile(native_fmu("fmi2"), tmp_path / "it.fmu")
    monkeypatch.setattr(surveying, "WAYS", {**WAYS, "in C": late})
    with pytest.raises(typer.Exit) as ended:
        survey_folder(tmp_path, TIMEOUT_S)
    said = capsys.readouterr().out
    assert ended.value.exit_code == 1
    assert said.startswith("differs  it.fmu\n")
    assert re.search(r"    in C: \S+ by 1e-06 at t = 0.0234375 s\n", said)


@pytest.mark.slow
def test_an_fmu_without_outputs_agrees_with_nobody(
    native_fmu: Callable[[str], Path], tmp_path: Path
) -> None:
    with zipfile.ZipFile(native_fmu("fmi2")) as archive:
        text = archive.read("modelDescription.xml").decode()
    outputs = [(one, "") for one in re.findall("<Outputs>.*?</Outputs>", text, re.S)]
    silent = ('causality="output"', 'causality="local"')
    changed(native_fmu("fmi2"), tmp_path / "silent.fmu", silent, *outputs)
    done = seatrial("fmu", "survey", str(tmp_path), "--json", cwd=tmp_path)
    (one,) = json.loads(done.stdout)["result"]["fmus"]
    assert (done.returncode, one["status"], one["differences"]) == (0, "runs, no outputs", {})
    assert one["ways"] == list(EVERY)


@pytest.mark.slow
def test_a_run_that_ends_elsewhere_differs_without_bounds(
    native_fmu: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def shorter(fmu: Any, experiment: Any) -> Any:
        return {name: values[:-2] for name, values in WAYS["in Python"](fmu, experiment).items()}

    shutil.copyfile(native_fmu("fmi2"), tmp_path / "it.fmu")
    monkeypatch.setattr(surveying, "WAYS", {**WAYS, "in C": shorter})
    (one,) = survey(fmus_in(tmp_path), TIMEOUT_S)
    assert one.status == "differs"
    assert {way: apart.value for way, apart in one.differing.items()} == {"in C": math.inf}


def test_an_fmu_that_opens_links_is_not_run(tmp_path: Path) -> None:
    build_fmu(named_sources()["serial-gateway"], tmp_path / "gateway.fmu")
    (one,) = survey(fmus_in(tmp_path), TIMEOUT_S)
    assert (one.status, one.ways) == ("not run", ())
    assert one.unfit.startswith("it would open its links: ")


@pytest.mark.slow
def test_folders_of_any_name_do(native_fmu: Callable[[str], Path], tmp_path: Path) -> None:
    folder = tmp_path / 'Bäu 🐳 {x} "50%"'
    folder.mkdir()
    shutil.copyfile(native_fmu("fmi2"), folder / "it.fmu")
    (one,) = survey(fmus_in(folder), TIMEOUT_S)
    assert (one.status, one.ways) == ("agrees", EVERY)


def test_a_run_that_hangs_is_ended(
    native_fmu: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copyfile(native_fmu("fmi2"), tmp_path / "it.fmu")
    monkeypatch.setattr(surveying, "WAYS", {"in Python": lambda *_: time.sleep(600.0)})
    (one,) = survey(fmus_in(tmp_path), 0.3)
    assert one.problems == {"in Python": "took longer than 0.3 s"}


def test_a_folder_without_fmus_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no \.fmu file is in it"):
        fmus_in(tmp_path)
    with pytest.raises(InputError, match="is no folder"):
        fmus_in(tmp_path / "nowhere")
