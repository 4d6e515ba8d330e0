"""Loading FMUs: folders, broken files, and the same numbers in both carriers."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

OUTPUTS = ["total", "through", "steps", "was_on", "said"]


def test_both_carriers_give_the_same_values(counter: ComponentSource, counter_fmu: Path) -> None:
    instances = [
        open_instance(load_fmu(counter_fmu), "a"),
        DirectInstance(counter.component_class()("b")),
    ]
    records = []
    for instance in instances:
        instance.set_start({"gain": 0.3, "u": 1.0 / 3.0, "on": True, "say": "água"})
        instance.initialise(0.0, 1.0)
        instance.begin()
        read, write = instance.reader(OUTPUTS), instance.writer(["u", "many", "knob"])
        rows = [read()]
        for k in range(50):
            write([k / 7.0, k, 1.0 + k])
            instance.step(k * 0.02, 0.02)
            rows.append(read())
            if k == 20:
                state = instance.get_state()
            if k == 30:
                instance.set_state(state)
                instance.step(21 * 0.02, 0.02)
                rows.append(read())
                instance.free_state(state)
                break
        records.append(rows)
        instance.terminate()
        instance.free()
    assert records[0] == records[1]
    assert records[0][1][2:] == [1, True, "água"]
    variables = [i.variables for i in instances]
    assert variables[0] == variables[1]
    assert instances[0].feedthrough == instances[1].feedthrough


@pytest.mark.parametrize("carrier", ["fmu", "direct"])
def test_a_failing_component_ends_in_one_clear_error(
    carrier: str, counter: ComponentSource, counter_fmu: Path
) -> None:
    instance = (
        open_instance(load_fmu(counter_fmu), "boat")
        if carrier == "fmu"
        else DirectInstance(counter.component_class()("boat"))
    )
    instance.initialise(0.0, 1.0)
    instance.begin()
    instance.writer(["say"])(["raise"])
    with pytest.raises(SimulationError, match=r"(?s)boat.*t = 0\.25 s.*ValueError: 100% broken"):
        instance.step(0.25, 0.01)
    instance.free()


def test_unsafe_cache_folder_is_refused(counter_fmu: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path / "São João"))
    with pytest.raises(InputError, match="plain ASCII"):
        load_fmu(counter_fmu.rename(tmp_path / "other.fmu"))


def test_unsafe_home_falls_back_to_a_temporary_folder(counter_fmu: Path, tmp_path: Path) -> None:
    """A home with an accent would crash pythonfmu's binary: the whole run, in a process."""
    code = (
        "import sys; from pathlib import Path; from seatrial.fmi.loading.load import *; "
        "f = load_fmu(Path(sys.argv[1])); print(f.folder); i = open_instance(f, 'b'); "
        "i.initialise(0.0, 1.0); i.begin(); i.step(0.0, 0.1); i.free()"
    )
    environment = {k: v for k, v in os.environ.items() if k != "SEATRIAL_CACHE"}
    environment["XDG_CACHE_HOME"] = str(tmp_path / "cão+1%")
    done = subprocess.run(
        [sys.executable, "-c", code, str(counter_fmu)],
        capture_output=True, text=True, check=True, env=environment,
    )  # fmt: skip
    folder = Path(done.stdout.strip())
    assert "cão" not in str(folder)
    assert not folder.exists()  # a temporary folder ends with its process
    assert not (tmp_path / "cão+1%").exists()


def test_an_unpacked_folder_that_lost_a_file_is_unpacked_again(counter_fmu: Path) -> None:
    folder = load_fmu(counter_fmu).folder
    (folder / "modelDescription.xml").unlink()
    os.utime(counter_fmu)  # as another process would find it
    again = load_fmu(counter_fmu)
    assert (again.folder / "modelDescription.xml").is_file()
    open_instance(again, "boat").free()


def test_broken_files_are_named(write, tmp_path: Path, counter_fmu: Path) -> None:
    with pytest.raises(InputError, match=r"text\.fmu: not an FMU"):
        load_fmu(write("text.fmu", "not a zip"))
    with pytest.raises(InputError, match=r"gone\.fmu: No such file"):
        load_fmu(tmp_path / "gone.fmu")
    (tmp_path / "AframeSetPoint.fmu").write_bytes(b"")  # found where case does not matter
    with pytest.raises(InputError, match=r"did you mean 'AframeSetPoint\.fmu'"):
        load_fmu(tmp_path / "AFrameSetpoint.fmu")
    outside = tmp_path / "outside.fmu"
    with zipfile.ZipFile(outside, "w") as archive:
        archive.writestr("../../evil.txt", "x")
    with pytest.raises(InputError, match="outside its folder"):
        load_fmu(outside)
    empty = tmp_path / "empty.fmu"
    with zipfile.ZipFile(empty, "w") as archive:
        archive.writestr("readme.txt", "x")
    with pytest.raises(InputError, match=r"empty\.fmu: modelDescription\.xml: No such file"):
        load_fmu(empty)
    no_binary = tmp_path / "no_binary.fmu"
    with zipfile.ZipFile(counter_fmu) as whole, zipfile.ZipFile(no_binary, "w") as archive:
        for name in whole.namelist():
            if "linux64" not in name:
                archive.writestr(name, whole.read(name))
    with pytest.raises(InputError, match="binaries for win64"):
        open_instance(load_fmu(no_binary), "x")
