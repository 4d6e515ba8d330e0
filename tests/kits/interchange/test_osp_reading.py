"""System structures of OSP-IS: what is read, and every mistake with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.packages import is_package
from seatrial_kits.interchange.osp.reading import read_osp
from tests.kits.interchange.osp_files import GROUPS, write_osp


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the FMU, which is compiled once."""
    folder = tmp_path_factory.mktemp("osp")
    write_osp(folder)
    return folder


@pytest.fixture
def folder(shared: Path, tmp_path: Path) -> Path:
    (tmp_path / "fmi2.fmu").write_bytes((shared / "fmi2.fmu").read_bytes())
    return tmp_path


def test_a_structure_is_a_rig(shared: Path) -> None:
    package = read_osp(shared)
    assert (package.title, package.start, package.stop) == (shared.name, "0.0 s", "3.0 s")
    assert package.called["slave uno"] == "slave_uno"
    rig = package.rig
    assert (rig.file.algorithm, rig.step_ns) == ("plain-jacobi", 100_000_000)
    assert [one.entry.what for one in rig.components.values()][-2:] == [
        "sum of 3",
        "sum of 2 vectors of 2",
    ]
    assert any("'last': its step of 0.65 s is no multiple" in note for note in package.notes)
    system = assemble(rig)
    try:
        assert {name: part.every for name, part in system.parts.items()}["last"] == 6
        joints = {joint.target: joint for joint in system.joints}
        assert (joints["two.u"].factor, joints["two.u"].offset) == (2.5, -0.1)
        assert joints["slow.s"].source == "slave_uno.r"  # of a group inside a group
        assert joints["two.q[2]"].source == "slave_uno.x"  # written from input to output
        assert system.parts["slave_uno"].given["s"].value == "ahoy"
    finally:
        system.free()


@pytest.mark.parametrize("algorithm", ["plain-jacobi", "jacobi", "gauss-seidel", "extrapolated"])
def test_no_algorithm_delays_a_sum(algorithm: str, shared: Path) -> None:
    system = assemble(read_osp(shared).rig.changed({"algorithm": algorithm}))
    try:
        master = Master(system)
        master.initialise()
        for _ in range(4):
            master.step()
            values = {".".join(n): v for n, v in zip(master.names, master.signals, strict=True)}
            terms = [values[name] for name in ("slave_uno.x", "two.x", "two.y")]
            assert values["total.out"] == sum(terms)
            assert values["forces.out[1]"] == values["slave_uno.p[2]"] + values["two.p[2]"]
    finally:
        system.free()


MISTAKES = [
    ('version="0.1"', 'version="0.2"', "line 2: version '0.2'"),
    ("<Algorithm>fixedStep", "<Algorithm>fixedstp", "unknown Algorithm 'fixedstp'; did you mean"),
    ("<BaseStepSize>0.1", "<BaseStepSize>-0.1", "line 5: BaseStepSize: must be above 0"),
    ("<EndTime>3.0", "<EndTime>soon", "EndTime: a time in s, at most 9e.09, is needed, found 'soon'"),
    ("<EndTime>3.0</EndTime>", "<EndTim>3.0</EndTim>", "EndTim in OspSystemStructure is not supported"),
    ('"two" source="fmi2.fmu"', '"two" source="no.fmu"', "simulator 'two': .*no.fmu: No such file"),
    (
        '"two" source="fmi2.fmu"',
        '"two" source="proxyfmu://localhost:9090?file=fmi2.fmu"',
        "simulator 'two': source 'proxyfmu://localhost:9090.file=fmi2.fmu': FMUs at a path, ",
    ),
    ('name="two" source', 'name="three" source', "a second simulator or function 'three'"),
    ('<Real value="0.7"/>', '<Real value="fast"/>', "line 20: Real: value: a finite number"),
    ('<Real value="0.7"/>', '<Integer value="7"/>', "line 20: 'k' is of type float, found 7"),
    ('<InitialValue variable="gain">', '<InitialValue variable="k">', "line 21: a second value of 'k'"),
    ('<InitialValue variable="gain">', '<InitialValue variable="gian">', "unknown port 'gian'"),
    ('inputCount="3"', 'inputCount="3.5"', "inputCount: a whole number from 1 to 1000"),
    ('inputCount="3"', 'inputCount="4"', r"function 'total': nothing is connected to 'in\[3\]'"),
    ('inputCount="3"', 'inputCount="2"', r"function 'total': unknown signal 'in\[2\]'"),
    ('function="total" name="in[1]"', 'function="total" name="in[0]"', r"'in\[0\]' is connected twice"),
    ('dimension="2"', 'dimension="3"', r"'in\[0\]' has 3 signals, the group .* has 2 variables"),
    ('function="same" name="in"', 'function="sane" name="in"', "unknown function 'sane'"),
    ('simulator="two" name="q[1]"', 'simulator="three" name="u"', "fed twice, first by"),
    ('simulator="two" name="q[1]"', 'simulator="two" name="x"', "two: x is output, input is needed"),
    ('simulator="two" name="q[1]"', 'simulator="too" name="q[1]"', "unknown simulator 'too'"),
    ('name="takes"', 'name="tokes"', "fmi2_OspModelDescription.xml: unknown group 'tokes'"),
    ('name="takes"', 'name="pair in"', "group 'gives' has 0 variables, group 'pair in' has 2"),
    (
        '<Variable simulator="slow" name="y"/><Signal',
        '<Variable simulator="slow" name="j"/><Signal',
        "slow: j is no real number",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after", "message"), MISTAKES)
def test_a_mistake_is_named(before: str, after: str, message: str, folder: Path) -> None:
    file = write_osp(folder, (before, after))
    with pytest.raises(InputError, match=message):
        assemble(read_osp(file).rig)


def test_groups_of_one_name_are_refused(folder: Path) -> None:
    file = write_osp(folder)
    doubled = GROUPS.replace("takes texts", "same").replace("gives texts", "same")
    (folder / "fmi2_OspModelDescription.xml").write_text(doubled, "utf-8")
    text = file.read_text("utf-8").replace('name="gives"', 'name="same"')
    file.write_text(text, "utf-8")
    with pytest.raises(InputError, match="2 groups are called 'same'"):
        read_osp(file)


def test_groups_stand_beside_the_structure_too(folder: Path) -> None:
    (folder / "fmus").mkdir()
    (folder / "fmi2.fmu").rename(folder / "fmus" / "fmi2.fmu")
    text = write_osp(folder / "fmus").read_text("utf-8")
    (folder / "fmus" / "fmi2_OspModelDescription.xml").rename(
        folder / "fmi2_OspModelDescription.xml"
    )
    (folder / "own.xml").write_text(text.replace('"fmi2.fmu"', '"fmus/fmi2.fmu"'), "utf-8")
    package = read_osp(folder / "own.xml")
    assert package.title == "own"
    assert package.rig.components["two"].entry.fmu == "fmus/fmi2.fmu"


def test_what_is_not_the_same_here_is_noted(folder: Path) -> None:
    file = write_osp(
        folder,
        ("    <BaseStepSize>0.1</BaseStepSize>\n", ""),
        ('stepSize="0.3"', 'stepSize="0.5"'),
        ('<InitialValue variable="gain"><Real value="-1.5"/>', '<InitialValue variable="u"><Real value="1"/>'),
        ('<Variable simulator="three" name="y"/>', '<Variable simulator="three" name="echo"/>'),
        ('<Variable simulator="slow" name="u"/>', '<Variable simulator="slow" name="speed"/>'),
    )  # fmt: skip
    notes = "\n".join(read_osp(file).notes)
    assert "there is no BaseStepSize: 0.1 s is taken, as libcosim does" in notes
    assert "two.u is fed by a connection; its initial value is not used" in notes
    assert "steps of 5 and 6 base steps" in notes


def test_what_is_a_package(shared: Path) -> None:
    assert is_package(str(shared))
    assert is_package("a.xml")
    assert not is_package("hydrone-landing")
