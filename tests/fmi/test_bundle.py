"""FMUs side by side in one process, their bytes, and what they need on the target machine."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.building.bundle import bundle, bundled
from seatrial.fmi.building.export import build_fmu, fmu_bytes
from seatrial.fmi.components.source import find_source, shipped_sources
from seatrial.fmi.loading.load import load_fmu, open_instance
from tests.kit import needs_kits

from . import boats
from .conftest import Raw, source


def test_two_versions_of_one_fmu_each_run_their_own_code(write, tmp_path: Path) -> None:
    raws = []
    for version, number in (("old", 1.0), ("new", 2.0)):
        text = boats.USES_HELPER.replace("constants.NUMBER +", f"{number} +")
        file = write(f"{version}/boat.py", text)
        write(f"{version}/constants.py", "NUMBER = 0.0\n")
        path = build_fmu(source(file, "Boat"), tmp_path / f"{version}.fmu")
        raws.append(Raw(path, tmp_path / f"{version}-unpacked"))
    slaves = [raw.start() for raw in raws]
    assert [raw.get("value") for raw in raws] == [1.0, 2.0]
    for slave in slaves:
        slave.freeInstance()


def test_equal_script_and_helper_names_do_not_meet(write, tmp_path: Path) -> None:
    raws = []
    for owner, number in (("ana", 111.0), ("bia", 222.0), ("eva", 333.0)):
        file = write(f"{owner}/boat.py", boats.USES_HELPER)
        write(f"{owner}/constants.py", f"NUMBER = {number}\n")
        path = build_fmu(source(file, "Boat"), tmp_path / f"{owner}.fmu")
        raws.append(Raw(path, tmp_path / f"{owner}-unpacked"))
    slaves = [raw.start() for raw in raws]
    assert [raw.get("value") for raw in raws] == [111.0, 222.0, 333.0]
    for slave in slaves:
        slave.freeInstance()
    assert not {"boat", "constants"} & set(sys.modules)


def test_the_same_fmu_twice_in_one_process(counter_fmu: Path, tmp_path: Path) -> None:
    first, second = Raw(counter_fmu, tmp_path / "1"), Raw(counter_fmu, tmp_path / "2")
    a, b = first.start(u=1.0), second.start(u=2.0)
    for k in range(3):
        a.doStep(k * 0.1, 0.1)
        b.doStep(k * 0.1, 0.1)
    assert (first.get("total"), second.get("total")) == (3.0, 6.0)
    a.freeInstance()
    b.freeInstance()


def test_builds_are_identical_whatever_the_folder_process_and_hash_seed(
    write, tmp_path: Path
) -> None:
    here = write("a/counter.py", boats.COUNTER)
    there = write("somewhere else/counter.py", boats.COUNTER)
    own = fmu_bytes(source(here, "Counter"))
    assert fmu_bytes(source(there, "Counter")) == own
    code = (
        "import sys; from pathlib import Path; from seatrial.fmi.components.source import find_source; "
        "from seatrial.fmi.building.export import build_fmu; "
        "build_fmu(find_source('counter.py:Counter', Path(sys.argv[1])), Path(sys.argv[2]))"
    )
    target = tmp_path / "elsewhere.fmu"
    environment = {**os.environ, "PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo"}
    command = [sys.executable, "-c", code, str(there.parent), str(target)]
    subprocess.run(command, check=True, env=environment)
    assert target.read_bytes() == own


def test_a_module_of_the_same_name_from_elsewhere_is_not_taken(
    write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    constants = ModuleType("constants")
    constants.NUMBER = 7.0
    monkeypatch.setitem(sys.modules, "constants", constants)
    write("mine/constants.py", "NUMBER = 1.0\n")
    boat = source(write("mine/boat.py", boats.USES_HELPER), "Boat").component_class()("boat")
    boat.initialise()
    assert boat.get("value") == 1.0
    assert sys.modules["constants"] is constants


def test_building_leaves_the_process_as_it_was(write, tmp_path: Path) -> None:
    file = write("boat.py", boats.USES_HELPER)
    write("constants.py", "NUMBER = 1.0\n")
    paths, folder = list(sys.path), Path.cwd()
    build_fmu(source(file, "Boat"), tmp_path / "boat.fmu")
    assert (sys.path, Path.cwd()) == (paths, folder)
    assert not {"boat", "constants"} & set(sys.modules)
    assert {p.name for p in tmp_path.iterdir()} == {"boat.py", "constants.py", "boat.fmu"}


def test_an_fmu_carries_no_more_than_it_imports(counter_fmu: Path) -> None:
    with zipfile.ZipFile(counter_fmu) as archive:
        names = archive.namelist()
    for absent in ("plant.py", "units.py", "export.py", "builder.py"):
        assert not any(name.endswith(f"/{absent}") for name in names)
    assert {n.split("/")[1] for n in names if n.startswith("binaries/")} == {"linux64", "win64"}


@pytest.mark.slow
def test_a_missing_package_is_named_with_its_cure(write, tmp_path: Path) -> None:
    write("packages/only_here/__init__.py", "X = 1\n")
    file = write(
        "boat.py",
        "import only_here\nfrom seatrial.model.component import Component\n\n\n"
        'class Boat(Component):\n    """Needs a package."""\n',
    )
    build = (
        "import sys; from pathlib import Path; from seatrial.fmi.components.source import find_source; "
        "from seatrial.fmi.building.export import build_fmu; "
        "build_fmu(find_source('boat.py:Boat', Path(sys.argv[1])), Path(sys.argv[2]))"
    )
    fmu = tmp_path / "boat.fmu"
    with_package = {**os.environ, "PYTHONPATH": str(tmp_path / "packages")}
    subprocess.run(
        [sys.executable, "-c", build, str(file.parent), str(fmu)], check=True, env=with_package
    )
    load = (
        "import sys; from pathlib import Path; from seatrial.fmi.loading.load import *; "
        "open_instance(load_fmu(Path(sys.argv[1])), 'b')"
    )
    done = subprocess.run(
        [sys.executable, "-c", load, str(fmu)], capture_output=True, text=True, check=False
    )
    assert "needs the Python package(s) only_here" in done.stderr
    assert 'pip install "only_here"' in done.stderr
    assert "could not be instantiated" in done.stderr


PLAIN = (
    "from seatrial.model.component import Component, Output\n\n\n"
    'class Boat(Component):\n    """Says a number."""\n\n    value = Output("1", "n")\n\n'
    "    def outputs(self, t):\n        self.value = NUMBER\n"
)


@pytest.mark.interop
@pytest.mark.parametrize(
    "data",
    [
        b"\xef\xbb\xbf" + PLAIN.replace("NUMBER", "7.0").encode(),
        PLAIN.replace("NUMBER", "7.0").replace("\n", "\r\n").encode(),
        ("\f" + PLAIN.replace("NUMBER", "7.0")).encode(),
        PLAIN.replace("NUMBER", "7.0").replace("Says", "Says\u2028or\u0085").encode(),
        ("# -*- coding: latin-1 -*-\n" + PLAIN.replace("NUMBER", "7.0 * len('é')")).encode("latin-1"),
        ("import constants; " + PLAIN.replace("NUMBER", "constants.NUMBER")).encode(),
        PLAIN.replace("NUMBER", "__import__('math').floor(7.5)").encode(),
        PLAIN.replace("        self", "        import constants as c\n        self").replace("NUMBER", "c.NUMBER").encode(),
        PLAIN.replace("        self", "        from seatrial.model.units import quantity\n        self").replace("NUMBER", "quantity('7', '1')").encode(),
        ("try:\n    import nowhere_at_all\nexcept ImportError:\n    nowhere_at_all = None\n" + PLAIN.replace("NUMBER", "7.0")).encode(),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import nowhere_at_all\nelse:\n    from constants import NUMBER\n" + PLAIN).encode(),
        ("from typing import TYPE_CHECKING\nif not TYPE_CHECKING:\n    from constants import NUMBER\n" + PLAIN).encode(),
    ],
    ids=[
        "byte-order mark", "CRLF", "form feed", "odd line separators", "coding cookie", "semicolon",
        "no import", "import in a method", "library import in a method", "optional import",
        "TYPE_CHECKING else", "not TYPE_CHECKING",
    ],
)  # fmt: skip
def test_python_as_people_write_it(data: bytes, write, tmp_path: Path) -> None:
    file = write("boat.py", "")
    file.write_bytes(data)
    write("constants.py", "NUMBER = 7.0\n")
    raw = Raw(build_fmu(source(file, "Boat"), tmp_path / "boat.fmu"), tmp_path / "boat")
    raw.start()
    assert raw.get("value") == 7.0
    raw.slave.freeInstance()


def test_a_component_needs_no_docstring(write, tmp_path: Path) -> None:
    for number, doc in enumerate(("", '    """   """\n')):
        text = f"from seatrial.model.component import Component\nclass Boat(Component):\n{doc}    pass\n"
        build_fmu(source(write(f"{number}/boat.py", text), "Boat"), tmp_path / "boat.fmu")
    assert oct((tmp_path / "boat.fmu").stat().st_mode)[-3:] == "644"


def test_the_error_itself_survives_a_long_traceback(write, tmp_path: Path) -> None:
    deep = PLAIN.replace("NUMBER", "self.dig(900)") + (
        "\n    def dig(self, n):\n        return 1 / 0 if n == 0 else self.dig_on(n)\n"
        "\n    def dig_on(self, n):\n        return self.dig(n - 1 if n < 50 else 49)\n"
    )
    path = build_fmu(source(write("boat.py", deep), "Boat"), tmp_path / "boat.fmu")
    instance = open_instance(load_fmu(path), "boat")
    with pytest.raises(SimulationError, match="ZeroDivisionError: division by zero"):
        instance.initialise(0.0, 1.0)
    instance.free()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def broken(:\n", r"boat\.py, line 1: not Python"),
        ("import nowhere_at_all\nclass Boat: pass\n", "nowhere_at_all"),
        ("import plain_folder\nclass Boat: pass\n", "without an __init__.py"),
        ("x = 1\n", "unknown component 'Boat'"),
        ("class Boat: pass\n", "not a subclass of seatrial's Component"),
        ("raise RuntimeError('on import')\n", "on import"),
    ],
)
def test_bad_scripts_are_named(text: str, message: str, write, tmp_path: Path) -> None:
    write("plain_folder/module.py", "")
    with pytest.raises(InputError, match=message):
        build_fmu(source(write("boat.py", text), "Boat"), tmp_path / "boat.fmu")
    assert not (tmp_path / "boat.fmu").exists()


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ("nothing.py:Boat", "there is no file"),
        ("x.fmu", "there is no FMU"),
        ("trhuster", "did you mean 'thruster'"),
        ("json.py:Boat", "would hide a library"),
    ],
)
def test_sources_that_do_not_exist(named: str, message: str, write, tmp_path: Path) -> None:
    write("json.py", "")
    with pytest.raises(InputError, match=message):
        find_source(named, tmp_path)


# ---------------------------------------------------------------------- data files

READS = (
    "from pathlib import Path\n\n"
    "from seatrial.model.component import Component, Output\n"
    'DATA_FILES = ("polar.csv",)\n\n\n'
    'class Boat(Component):\n    """Says a number from a file."""\n\n'
    '    value = Output("1", "n")\n\n'
    "    def start(self, t):\n"
    '        self._value = float(Path(__file__).with_name("polar.csv").read_text())\n\n'
    "    def outputs(self, t):\n        self.value = self._value\n"
)


def test_data_files_travel_and_versions_keep_their_own(write, tmp_path: Path) -> None:
    raws = []
    for owner, number in (("ana", 111.0), ("bia", 222.0)):
        file = write(f"{owner}/boat.py", READS)
        data = write(f"{owner}/polar.csv", f"{number}\n")
        path = build_fmu(source(file, "Boat"), tmp_path / f"{owner}.fmu")
        data.unlink()
        raws.append(Raw(path, tmp_path / f"{owner}-unpacked"))
    slaves = [raw.start() for raw in raws]
    assert [raw.get("value") for raw in raws] == [111.0, 222.0]
    for slave in slaves:
        slave.freeInstance()


def test_data_files_and_late_imports_are_found_when_the_first_copy_is_gone(
    write, tmp_path: Path
) -> None:
    late = READS.replace("        self._value = ", "        import late\n\n        self._value = ")
    file = write("boat.py", late.replace(".read_text())", ".read_text()) + late.MORE"))
    write("polar.csv", "111.0\n")
    write("late.py", "MORE = 0.5\n")
    path = build_fmu(source(file, "Boat"), tmp_path / "boat.fmu")
    unpacked = [tmp_path / name for name in ("first", "second", "third")]
    first, second = Raw(path, unpacked[0]), Raw(path, unpacked[1])
    first.instantiate("first").freeInstance()
    slave = second.instantiate("second")
    shutil.rmtree(unpacked[0])
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    assert second.get("value") == 111.5
    slave.freeInstance()
    shutil.rmtree(unpacked[1])
    third = Raw(path, unpacked[2])
    slave = third.start()
    assert third.get("value") == 111.5
    slave.freeInstance()


def test_data_files_lie_beside_their_module_and_count_in_the_hash(write) -> None:
    write("shapes/__init__.py", 'DATA_FILES = ["whole.bin"]\n')
    write("shapes/sail.py", 'DATA_FILES: tuple[str, ...] = ("cloth.txt",)\n')
    write("shapes/whole.bin", "\0 any bytes \r\n")
    cloth = write("shapes/cloth.txt", "red\n")
    file = write("boat.py", "import shapes.sail\n" + PLAIN.replace("NUMBER", "1.0"))
    boat = source(file, "Boat")
    first = bundled(boat)
    root = first.script.replace("boat_Boat", "bundle")
    assert first.files[f"{root}/shapes/cloth.txt"] == b"red\n"
    assert (
        first.files[f"{root}/shapes/whole.bin"] == (file.parent / "shapes/whole.bin").read_bytes()
    )
    cloth.write_text("tan\n")
    assert bundled(boat).script != first.script


@needs_kits("sailing")
def test_tables_of_a_shipped_component_travel_as_printed() -> None:
    sailboat = shipped_sources()["sailboat"]
    files = bundled(sailboat).files
    (table,) = [data for name, data in files.items() if name.endswith("/sail_naca0015.csv")]
    digest = "1345bbe865c0676a579f4967380f97794a2bc44990622f547fcccc35d6286993"
    assert hashlib.sha256(table).hexdigest() == digest
    servo = shipped_sources()["servo"]
    assert not any(n.endswith(".csv") for n in bundled(servo).files)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ('("polar.csv",)', r"boat\.py: DATA_FILES names 'polar\.csv', and there is no such file"),
        ('("../polar.csv",)', r"boat\.py, line 1: DATA_FILES must be a tuple of names"),
        ('("boat.py",)', "must be a tuple of names"),
        ('("",)', "must be a tuple of names"),
        ('"polar.csv"', "must be a tuple of names"),
        ("(1, 2)", "must be a tuple of names"),
        ("tuple(glob('*.csv'))", "must be a tuple of names"),
    ],
)
def test_bad_data_files_are_named(value: str, message: str, write, tmp_path: Path) -> None:
    file = write("boat.py", f"DATA_FILES = {value}\n" + PLAIN.replace("NUMBER", "1.0"))
    with pytest.raises(InputError, match=message):
        bundle("boat_Boat", b"import boat\n", file.parent)


@pytest.mark.parametrize(
    "imports",
    [
        "from seatrial.component import Component, Output",
        "import seatrial.component\nfrom seatrial.model.ports import Output\n"
        "Component = seatrial.component.Component",
        "from seatrial import component\nComponent, Output = component.Component, component.Output",
    ],
)
@needs_kits("can")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_modules_travel_by_the_paths_that_they_had(imports: str, write, tmp_path: Path) -> None:
    text = f"""{imports}
from seatrial.links.can.frame import Frame


class Boat(Component):
    value = Output("1", "bytes of a frame")

    def outputs(self, t):
        self.value = float(len(Frame(1, b"abc").data))
"""
    path = build_fmu(source(write("boat.py", text), "Boat"), tmp_path / "boat.fmu")
    raw = Raw(path, tmp_path / "unpacked")
    slave = raw.start()
    assert raw.get("value") == 3.0
    slave.freeInstance()
