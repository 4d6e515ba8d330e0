"""An hour of everything at once: a verdict or a clear end each time, and a vehicle in neutral."""

from __future__ import annotations

import csv
import itertools
import json
import os
import random
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from ..kits.arduino.bench import need
from .disturbances import LAST, MILD
from .rig import SAFE, WAIT_S, Episode, prepare

SECONDS = float(os.environ.get("SEATRIAL_CHAOS_S", "3600"))
SEED = int(os.environ.get("SEATRIAL_CHAOS_SEED", "17"))
EPISODE = os.environ.get("SEATRIAL_CHAOS_EPISODE")
"""The number of the only episode to run, which repeats one."""
_SETTLE_S = 15.0
"""Wall time in which what a killed supervisor leaves ends in order."""


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="processes, terminals, name spaces")
def test_every_episode_ends_clearly_and_leaves_nothing(tmp_path: Path) -> None:
    for backend in ("host", "simavr"):
        need(backend)
    prepare(tmp_path)
    names = subprocess.run(["unshare", "-Urm", "true"], check=False, capture_output=True)
    ends = ["none", *LAST, "full disk" if names.returncode == 0 else "none"]
    until = time.monotonic() + SECONDS
    problems: list[str] = []
    done: Counter[str] = Counter()
    for number in itertools.count() if EPISODE is None else [int(EPISODE)]:
        if time.monotonic() > until:
            break
        chance = random.Random(f"{SEED}-{number}")
        kinds = chance.sample(list(MILD), chance.randint(0, 3))
        end = ends[number % len(ends)]
        found = episode(tmp_path / str(number), number, chance, kinds, end)
        done.update(["episodes", *kinds, end])
        print(number, kinds, end, found, flush=True)
        if found:
            again = f"SEATRIAL_CHAOS_SEED={SEED} SEATRIAL_CHAOS_EPISODE={number}"
            problems += [f"{again} ({[*kinds, end]}, {tmp_path / str(number)}):", *found]
        else:
            shutil.rmtree(tmp_path / str(number))
    print(dict(done))
    assert not problems, "\n".join(problems)


def episode(
    folder: Path, number: int, chance: random.Random, kinds: list[str], end: str
) -> list[str]:
    """Run one; return what is wrong."""
    run = Episode(folder, number, chance, [*kinds, end])
    try:
        if run.wait_until_reachable():
            for kind in kinds:
                time.sleep(chance.uniform(0.0, 1.5))
                MILD[kind](run, chance)
            time.sleep(chance.uniform(0.0, 2.0))
            for _ in range(1 + (end == "twice")):
                if end in LAST:
                    LAST[end](run, chance)
        try:
            run.process.wait(WAIT_S)
        except subprocess.TimeoutExpired:
            return [f"it did not end: {run.left_processes()} {run.message}"]
        return wrong(run, end)
    finally:
        for pids in run.processes().values():
            for pid in pids:
                os.kill(pid, 9)
        run.close()


def wrong(run: Episode, end: str) -> list[str]:
    """Return what an ended run should not have left, or should have."""
    deadline = time.monotonic() + _SETTLE_S
    while (run.left_processes() or run.left_memory()) and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.2)  # the vehicle is read meanwhile
    found = [f"it left the process {line}" for line in run.left_processes()]
    found += [f"it left the shared memory {name}" for name in run.left_memory()]
    found += [f"it left {path}" for path in run.temporary.rglob("*")]
    cache = Path(os.environ["SEATRIAL_CACHE"])
    found += [f"it left {path}" for path in cache.glob("*/unpacking-*")]
    found += [f"it left {path}" for path in cache.glob("sketches/tmp*")]
    status, message = run.process.returncode, run.message
    if status not in ((-9, 137) if end == "supervisor" else (0, 1, 3)):
        found.append(f"status {status}: {message}")
    if "Traceback" in message or "seatrial itself" in message + run.output:
        found.append(f"a traceback: {message}")
    said = [line for line in message.splitlines() if line.startswith("seatrial: ")]
    if status == 3 and len(said) != 1:
        found.append(f"not one message: {message!r}")
    if run.vehicle.received and not run.vehicle.received.endswith(SAFE):
        found.append(f"the vehicle got last {run.vehicle.received[-40:]!r}: {message}")
    return found + wrong_record(run.out, status, message)


def wrong_record(out: Path, status: int, message: str) -> list[str]:
    """Return what is wrong with a run folder."""
    if not (out / "manifest.json").is_file():
        return [] if status == 3 else [f"status {status} without a manifest: {message}"]
    found = []
    if (said := json.loads((out / "manifest.json").read_text())["status"]) == "running":
        found.append(f"the manifest says {said}: {message}")
    if status in (0, 1) and said not in ("complete", "ended"):
        found.append(f"status {status} of a run that is {said}")
    found += [f"half a file: {path.name}" for path in out.glob(".*")]
    if not (out / "signals.csv").is_file():
        return [*found, "no record"]
    text = (out / "signals.csv").read_text()
    head, *rows = list(csv.reader(text.splitlines()))
    times = [float(row[0]) for row in rows]
    if not text.endswith("\n") or any(len(row) != len(head) for row in rows):
        found.append(f"the record is not whole: {text[-100:]!r}")
    if any(b <= a for a, b in itertools.pairwise(times)):
        found.append("times do not increase")
    return found
