"""Model descriptions of other tools: very many variables, and combinations that FMI forbids."""

import re
import time
from dataclasses import replace
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
from fmpy.validation import validate_fmu
from typer.testing import CliRunner

from benchmarks.big_models import RIG, TRIAL, description, write_fmu
from seatrial.cli.fmu import fmu_app
from seatrial.cli.main import app
from seatrial.errors import InputError
from seatrial.fmi.files.osp import osp_file
from seatrial.fmi.files.terminals import MemberReader
from seatrial.fmi.instance import Variables
from seatrial.fmi.loading.conformance import problems
from seatrial.fmi.loading.load import load_fmu
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.interchange.osp.joining import Groups

from .native import SLAVES, described_fmu

COUNT = 5_000
FMI2 = (SLAVES / "fmi2.xml").read_text("utf-8")
GAIN = 'name="gain" valueReference="2" causality="parameter" variability="tunable"'


@pytest.mark.parametrize("version", [2, 3])
def test_variables_are_not_kept_in_the_tree_of_xml(version: int, tmp_path: Path) -> None:
    fmu = load_fmu(described_fmu(tmp_path / "big.fmu", description(version, COUNT)))
    assert len(fmu.variables) == COUNT
    assert len(list(fmu.model.root.iter())) < 20
    assert not fmu.description.modelVariables
    assert not hasattr(next(iter(fmu.variables.values())), "__dict__")


def test_describe_shows_the_first_variables_and_how_many_there_are(tmp_path: Path) -> None:
    path = str(described_fmu(tmp_path / "big.fmu", description(2, COUNT)))
    runner = CliRunner()
    first = runner.invoke(fmu_app, ["describe", path]).output
    assert f"{COUNT} variables: 3500 local, 500 parameter, 500 input, 500 output" in first
    assert f"... and {COUNT - 200} more" in first
    assert len(first.splitlines()) < 450
    some = runner.invoke(fmu_app, ["describe", path, "--match", "unit49.part9.*"]).output
    assert some.count("unit49.part9.signal") == 10
    assert "more:" not in some


def test_a_combination_that_fmi_forbids_is_a_note(tmp_path: Path) -> None:
    assert GAIN in FMI2
    constant = FMI2.replace(GAIN, GAIN.replace("tunable", "constant"))
    fmu = load_fmu(described_fmu(tmp_path / "x.fmu", constant))
    assert fmu.notes[-1].endswith("together: gain (parameter, constant)")
    nonsense = FMI2.replace(GAIN, GAIN.replace("tunable", "wobbly"))
    with pytest.raises(InputError, match=r"'gain' .*unknown variability 'wobbly'"):
        load_fmu(described_fmu(tmp_path / "y.fmu", nonsense))


NAMES = ["a", "a.b[1,2].c", "der(a.b)", "der(x[3],2)", "'quoted name'.x", r"'it\'s'", "_a1"]
ODD = ["1a", "a b", "a..b", "a[]", "a[1", "der(a", "der()", "''", "'a", "a.", "ä", "a[1][2]"]


@pytest.mark.parametrize("name", [*NAMES, *ODD])
def test_names_of_the_structured_convention_as_fmpy_reads_them(name: str, tmp_path: Path) -> None:
    text = FMI2.replace('name="gain"', f"name={quoteattr(name)}").replace(
        " modelName=", ' variableNamingConvention="structured" modelName='
    )
    path = described_fmu(tmp_path / "x.fmu", text)
    said = [one for one in problems(load_fmu(path)) if "legal variable name" in one]
    fmpys = [one for one in validate_fmu(str(path)) if "legal variable name" in one]
    assert len(said) == len(fmpys) == (name in ODD)


def test_a_check_of_structured_names_takes_no_time(tmp_path: Path) -> None:
    """FMPy's parser takes 5 ms for each."""
    text = description(2, COUNT).replace(
        " modelName=", ' variableNamingConvention="structured" modelName='
    )
    fmu = load_fmu(described_fmu(tmp_path / "big.fmu", text))
    begun = time.process_time()
    assert problems(fmu) == []
    assert time.process_time() - begun < 5.0


def test_of_very_many_problems_the_first_are_listed(tmp_path: Path) -> None:
    text = re.sub("<InitialUnknowns>.*</InitialUnknowns>", "", description(2, COUNT))
    said = problems(load_fmu(described_fmu(tmp_path / "big.fmu", text)))
    assert len(said) == 1
    assert "expected set of variables" in said[0]
    assert len(said[0]) < 1_100
    text = text.replace('start="0"', "")
    said = problems(load_fmu(described_fmu(tmp_path / "bigger.fmu", text)))
    assert len(said) == 101
    assert "first 100" in said[-1]


def test_groups_of_many_variables_take_time_that_grows_with_their_number(tmp_path: Path) -> None:
    """Ten thousand groups in one file of OSP-IS, and all elements of a long array in one."""
    count = 10_000
    path = described_fmu(tmp_path / "big.fmu", description(2, count))
    groups = "".join(
        f'<Generic name="g{n}"><Variable ref="unit0.part0.signal0"/></Generic>'
        for n in range(count)
    )
    osp_file(tmp_path, "big").write_text(
        f"<OspModelDescription><VariableGroups>{groups}</VariableGroups></OspModelDescription>"
    )
    fmu = load_fmu(path)
    begun = time.process_time()
    found = Groups(fmu, tmp_path)
    assert all(found.named(f"g{n}").variables == ("unit0.part0.signal0",) for n in range(count))
    assert time.process_time() - begun < 5.0  # each in a list of all: a minute
    like = next(iter(fmu.variables.values()))
    array = Variables({f"x[{n}]": replace(like, name=f"x[{n}]") for n in range(count)})
    begun = time.process_time()
    assert MemberReader(array, ()).by_port({name: name for name in array}) == {"x": "x"}
    assert time.process_time() - begun < 5.0


@pytest.mark.interop
def test_a_trial_of_a_component_with_very_many_outputs(tmp_path: Path) -> None:
    """What it does not ask for is not recorded, not listed and not noted line by line."""
    write_fmu(tmp_path / "big.fmu", 3, 2 * COUNT * 10)
    (tmp_path / "rig.toml").write_text(
        RIG + '[connections]\n"first.unit999.part9.signal9" = "first.unit0.part0.signal1"\n'
    )
    (tmp_path / "trial.toml").write_text(TRIAL)
    trial = load_trial(str(tmp_path / "trial.toml")).changed({"seed": 2}, "here")
    result = run_trial(trial, tmp_path / "run")
    header = (tmp_path / "run/signals.csv").read_text().splitlines()[0].split(",")
    assert len(header) == 1 + 1000
    assert header[-1] == "first.unit999.part9.signal9"
    assert "1000 of 10000 outputs of first are recorded" in result.notes[0]
    assert "... (9999 in all)" in result.notes[1]
    assert len(result.notes[1]) < 2_000
    (tmp_path / "asked.toml").write_text(f'{TRIAL}[record]\nsignals = ["first.unit1*"]\n')
    asked = load_trial(str(tmp_path / "asked.toml"))
    assert not any("recorded" in note for note in run_trial(asked, tmp_path / "asked").notes)
    header = (tmp_path / "asked/signals.csv").read_text().splitlines()[0].split(",")
    assert len(header) == 1 + 10 * 111
    runner = CliRunner()
    first = runner.invoke(app, ["describe", str(tmp_path / "rig.toml")]).output
    assert len(first.splitlines()) < 230
    assert "... and 9799 more" in first
    some = runner.invoke(app, ["describe", str(tmp_path / "rig.toml"), "--match", "*.unit999.*"])
    assert "1 connections" in some.output
    assert some.output.count("first.unit999.part") == 11
    every = runner.invoke(app, ["describe", str(tmp_path / "rig.toml"), "--all"]).output
    assert len(every.splitlines()) > 9_999
