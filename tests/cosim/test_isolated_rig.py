"""Rigs with isolated components: the same record, and a whole one whatever their process does."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from tests.command import SEATRIAL

from ..fmi import crashing
from ..fmi.native import build_native_fmu

RIG = """
step = "100 ms"
[components]
boat = {{ fmu = "{fmu}", isolated = true, {keys} }}
twin = {{ fmu = "crashing.py:Crashing" }}
"""
WriteTrial = Callable[..., Path]


@pytest.fixture
def trial(write) -> WriteTrial:
    """Return a function that writes a trial of an isolated boat beside one that is not."""

    def trial(keys: str, fmu: str = "crashing.py:Crashing") -> Path:
        write("crashing.py", crashing.CRASHING)
        write("rig.toml", RIG.format(fmu=fmu, keys=keys))
        return write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')

    return trial


def rows(folder: Path) -> list[list[str]]:
    with (folder / "signals.csv").open(newline="") as file:
        return list(csv.reader(file))


def manifest(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "manifest.json").read_text())


@pytest.mark.parametrize(
    ("engine", "counts"),
    [pytest.param("fmu", (0, 99), marks=pytest.mark.interop), ("direct", (0, 1))],
)
def test_the_record_is_the_same_whoever_is_isolated(engine, counts, tmp_path: Path) -> None:
    shipped = load_trial("hydrone-open-landing").changed({"stop": "0.3 s"}, "the test")
    entries = shipped.rig.file.components
    records = set()
    for count in counts:
        isolated = list(entries)[:count]
        components = {
            name: {**entry.model_dump(exclude_unset=True), "isolated": name in isolated}
            for name, entry in entries.items()
        }
        rig = shipped.rig.changed({"components": components})
        out = tmp_path / str(len(isolated))
        result = run_trial(replace(shipped, rig=rig), out, engine=engine)
        assert result.status == "complete", result.error
        records.add((out / "signals.csv").read_bytes())
    assert len(records) == 1


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ('set = { how = "segfault" }', "boat: its process was ended by SIGSEGV in step(t = 0.3 s"),
        ('set = { how = "exit" }', "boat: its process exited with status 3 in step(t = 0.3 s"),
        pytest.param(
            'timeout = "4 s", set = { how = "spin" }',
            "boat: its process was ended for not answering within 4 s (the component's key "
            "'timeout') in step(t = 0.3 s",
            marks=pytest.mark.interop,
        ),
    ],
)
def test_an_end_in_the_middle_leaves_a_whole_record(keys, expected, trial, tmp_path: Path) -> None:
    out = tmp_path / "run"
    result = run_trial(load_trial(str(trial(keys))), out)
    assert (result.status, result.error) == ("failed", manifest(out)["error"])
    assert manifest(out)["status"] == "failed"
    assert expected in result.error
    assert rows(out) == [
        ["time", "boat.steps", "twin.steps"],
        *[[t, str(k), str(k)] for k, t in enumerate(("0.0", "0.1", "0.2", "0.3"))],
    ]
    assert json.loads((out / "timing.json").read_text())["steps"] == 3


@pytest.mark.interop
def test_a_native_fmu_that_crashes_ends_the_command_with_a_message(trial, tmp_path: Path) -> None:
    build_native_fmu("crash", tmp_path)
    trial(f"set = {{ how = {crashing.SEGFAULT} }}", "crash.fmu")
    for engine in ("fmu", "direct"):
        done = subprocess.run(
            [SEATRIAL, "run", "trial.toml", "--engine", engine, "--out", engine],
            cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 3
        assert "seatrial: boat: its process was ended by SIGSEGV in step(t = 0.3 s" in done.stderr
        assert len(rows(tmp_path / engine)) == 5
        assert (tmp_path / engine / "report.html").is_file()


def test_a_discarded_step_is_repeated_from_a_restored_state(write, tmp_path: Path) -> None:
    write(
        "coy.py",
        '"""Takes short steps only."""\n'
        "from seatrial.model.component import Component, Output\n\n\n"
        "class Coy(Component):\n"
        '    """Integrates time, in steps of 30 ms at most."""\n\n'
        '    y = Output("s", "time")\n\n'
        "    def start(self, t):\n        self.x = 0.0\n\n"
        "    def step(self, t, h):\n"
        '        if h > 0.03:\n            raise ValueError("too long")\n'
        "        self.x += h\n\n"
        "    def outputs(self, t):\n        self.y = self.x\n",
    )
    records = []
    for isolated in ("true", "false"):
        write(
            "rig.toml",
            f'step = "100 ms"\n[components]\na = {{ fmu = "coy.py:Coy", isolated = {isolated} }}\n',
        )
        path = write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
        out = tmp_path / isolated
        assert run_trial(load_trial(str(path)), out).error is None
        records.append(rows(out))
    assert records[0] == records[1]
    assert float(records[0][-1][1]) == pytest.approx(1.0, abs=1e-12)


def test_only_what_is_isolated_has_a_process_and_engines_agree(trial) -> None:
    rig = load_rig(str(trial('timeout = "2 min"').with_name("rig.toml")))
    for engine in ("fmu", "direct"):
        system = assemble(rig, engine)
        try:
            kinds = {name: type(part.instance) for name, part in system.parts.items()}
            assert kinds["boat"] is IsolatedInstance
            assert kinds["twin"] is not IsolatedInstance
            assert system.parts["boat"].sha256
        finally:
            system.free()


@pytest.mark.parametrize("timeout", ["0 s", "-1 s", "5 m", "long"])
def test_a_limit_that_is_no_positive_time_is_refused(timeout: str, trial) -> None:
    rig = load_rig(str(trial(f'timeout = "{timeout}"').with_name("rig.toml")))
    with pytest.raises(InputError, match=r"rig\.toml: components\.boat\.timeout: "):
        assemble(rig)


@pytest.mark.interop
@pytest.mark.parametrize(
    "closed",
    [
        "<&-",
        "<&- >&-",
        "<&- 2>&-",
        "<&- >&- 2>&-",
    ],
)
def test_a_command_without_standard_streams_runs_as_any(closed: str, trial, tmp_path: Path) -> None:
    trial('set = { how = "print" }')
    done = subprocess.run(
        f"exec '{SEATRIAL}' run trial.toml --out run {closed}",
        shell=True, cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert manifest(tmp_path / "run")["status"] == "complete"


@pytest.mark.interop
def test_what_a_component_prints_need_not_be_read(trial, tmp_path: Path) -> None:
    trial('set = { how = "print" }')
    process = subprocess.Popen(
        [SEATRIAL, "run", "trial.toml", "--out", "run"],
        cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stderr is not None
    process.stderr.close()
    assert process.wait(60) == 0
    assert manifest(tmp_path / "run")["status"] == "complete"


def interrupted(folder: Path, how: str, times: int) -> tuple[str, list[list[str]]]:
    """Run a trial of the command line as a terminal would, send Ctrl-C; return what is left."""
    process = subprocess.Popen(
        [SEATRIAL, "run", "trial.toml", "--set", f"boat.how={how}", "--set", "stop=100000 s",
         "--out", "run"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, process_group=0,
    )  # fmt: skip
    signals = folder / "run" / "signals.csv"
    for _ in range(600):
        if signals.is_file():
            break
        time.sleep(0.05)
    time.sleep(1.0)
    for _ in range(times):
        os.killpg(process.pid, signal.SIGINT)
        time.sleep(0.3)
    _, stderr = process.communicate(timeout=30)
    assert process.returncode == 3, stderr
    assert "Traceback" not in stderr
    return stderr, rows(folder / "run")


@pytest.mark.slow
def test_an_interrupt_stops_the_run_after_the_step(trial, tmp_path: Path) -> None:
    trial('timeout = "60 s"')
    stderr, record = interrupted(tmp_path, "fine", 1)
    assert "stopped" in stderr
    assert manifest(tmp_path / "run")["status"] == "stopped"
    assert len(record) > 100
    assert [int(row[1]) for row in record[1:]] == list(range(len(record) - 1))


@pytest.mark.interop
def test_a_second_interrupt_ends_the_wait_for_a_component_that_hangs(trial, tmp_path: Path) -> None:
    trial('timeout = "60 s"')
    _, record = interrupted(tmp_path, "sleep", 2)
    assert manifest(tmp_path / "run")["status"] == "stopped"
    assert len(record) == 5
