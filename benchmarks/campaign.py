"""Rate, processor time and memory of a long campaign: ``python -m benchmarks.campaign``.

The campaign is landings of the Hydrone, thrusters off, 20 s each, in process, drawn by Monte Carlo
over the masses of craft and drone. Beside it, as many processes as it has workers run bare
simulations of the same cases: rig assembled, values set, stepped to the end; no criteria, no table,
nobody who survives a crash. The two take turns: the campaign is halted (SIGSTOP) while the bare
processes run, for a third of the time, so that both meet the same machine. Rates are of the turns
from the first case that ended on; processor time counts all processes of the campaign. Memory is
that of each of them, at every turn: RSS counts what they share in each.
``--write`` puts the table into docs/scale.md, that of ``--engine native`` into its own place.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from .pages import write_measured

CAMPAIGN = """
trials = ["hydrone-open-landing"]
keep = "none"
[design]
kind = "monte-carlo"
count = {count}
[design.vary]
"downwash.mass" = {{ uniform = ["1 kg", "9 kg"] }}
"hull.mass" = {{ normal = ["22 kg", "1 kg"] }}
"""
_BARE = """
import json, sys, time
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare

cases = load_campaign(sys.argv[1]).cases()
number = int(sys.argv[2])
for line in sys.stdin:
    begun, wall, count = time.process_time(), time.perf_counter(), 0
    while time.perf_counter() - wall < float(line):
        trial = cases[number % len(cases)].trial
        prepared = prepare(trial, {engine!r}, Hooks())
        master = prepared.started()
        steps = trial.steps
        while master.steps < steps:
            master.advance(steps - master.steps)
        master.terminate()
        prepared.system.free()
        number, count = number + 1, count + 1
    print(json.dumps([count, time.perf_counter() - wall, time.process_time() - begun]), flush=True)
"""
_TICK = os.sysconf("SC_CLK_TCK")


@dataclass
class Turns:
    """What turns of one side came to."""

    cases: int = 0
    wall: float = 0.0
    """Of all places together, s."""
    processor: float = 0.0
    """s."""


@dataclass
class Seen:
    """What was seen of a whole campaign and of the bare processes beside it."""

    campaign: Turns = field(default_factory=Turns)
    bare: Turns = field(default_factory=Turns)
    memory: list[list[float]] = field(default_factory=list)
    """RSS, MB, of the parent and of each worker, at every turn."""
    whole: float = 0.0
    """Processor time of the command, with its start and end, s."""


class Bare:
    """A process that runs bare simulations for as long as it is asked to."""

    def __init__(self, path: Path, first: int, engine: str) -> None:
        command = [sys.executable, "-c", _BARE.replace("{engine!r}", repr(engine)), str(path)]
        self._process = subprocess.Popen(
            [*command, str(first)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def begin(self, wall: float) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{wall}\n")
        self._process.stdin.flush()

    def add_to(self, turns: Turns) -> None:
        assert self._process.stdout is not None
        count, wall, processor = json.loads(self._process.stdout.readline())
        turns.cases += count
        turns.wall += wall
        turns.processor += processor

    def end(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def members(group: int) -> list[int]:
    """Return the processes of a group, the first one it began with first."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            after = stat.read_text().rpartition(")")[2].split()
            if int(after[2]) == group and after[0] != "Z":
                found.append(int(stat.parent.name))
    return sorted(found, key=lambda process: (process != group, process))


def processor_time(processes: list[int]) -> float:
    """Return the processor time of processes and of their children that have ended, s."""
    ticks = 0
    for process in processes:
        after = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        ticks += sum(map(int, after[11:15]))
    return ticks / _TICK


def resident(process: int) -> float:
    """Return the memory of a process, MB."""
    status = Path(f"/proc/{process}/status").read_text("ascii")
    return next(int(line.split()[1]) for line in status.splitlines() if "VmRSS" in line) / 1024


def ended(log: Path) -> int:
    """Return how many cases have ended."""
    return log.read_bytes().count(b"\n") if log.is_file() else 0


def watched(count: int, jobs: int, engine: str, turn: float) -> Seen:
    """Run a campaign in turns with bare simulations, and return what was seen."""
    seen = Seen()
    with tempfile.TemporaryDirectory(prefix="seatrial-") as place:
        path, out = Path(place, "landings.toml"), Path(place, "out")
        path.write_text(CAMPAIGN.format(count=count), "utf-8")
        bare = [Bare(path, 7919 * k, engine) for k in range(jobs)]
        take_turn(bare, 0.1, Turns())  # imports, and the first case that fills caches
        options = ["--engine", engine, "--jobs", str(jobs), "--out", str(out), "--no-report"]
        campaign = subprocess.Popen(
            [sys.executable, "-c", "from seatrial.cli import main; main()", "run", path, *options],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        log = out / "ended.jsonl"
        while ended(log) < jobs and campaign.poll() is None:
            time.sleep(0.02)
        while campaign.poll() is None:
            if not campaign_turn(campaign, log, turn, jobs, seen):
                break
            os.killpg(campaign.pid, signal.SIGSTOP)
            take_turn(bare, turn / 2.0, seen.bare)
            os.killpg(campaign.pid, signal.SIGCONT)
        _, status, usage = os.wait4(campaign.pid, 0)
        campaign.returncode = os.waitstatus_to_exitcode(status)
        seen.whole = usage.ru_utime + usage.ru_stime
        for each in bare:
            each.end()
    return seen


def campaign_turn(
    campaign: subprocess.Popen[bytes], log: Path, turn: float, jobs: int, seen: Seen
) -> bool:
    """Let a campaign run for one turn; False if its last case ended meanwhile."""
    processes = members(campaign.pid)
    if len(processes) < jobs + 1 or not log.is_file():
        return False
    cases, begun, used = ended(log), time.perf_counter(), processor_time(processes)
    time.sleep(turn)
    try:
        if not log.is_file() or members(campaign.pid) != processes:
            return False
        taken = Turns(
            ended(log) - cases,
            (time.perf_counter() - begun) * jobs,
            processor_time(processes) - used,
        )
        memory = [resident(process) for process in processes]
    except OSError:
        return False
    for key, value in vars(taken).items():
        setattr(seen.campaign, key, getattr(seen.campaign, key) + value)
    seen.memory.append(memory)
    return True


def take_turn(bare: list[Bare], wall: float, turns: Turns) -> None:
    """Let the bare processes run side by side for one turn."""
    for each in bare:
        each.begin(wall)
    for each in bare:
        each.add_to(turns)


def table(seen: Seen, count: int, jobs: int) -> str:
    """Return what was seen in Markdown."""
    campaign, bare = seen.campaign, seen.bare
    rate, bare_rate = (jobs * side.cases / side.wall for side in (campaign, bare))
    each, bare_each = (side.processor / side.cases for side in (campaign, bare))
    workers = [max(column) for column in list(zip(*seen.memory, strict=True))[1:]]
    early, late = (sum(seen.memory[place]) for place in (len(seen.memory) // 10, -1))
    return "\n".join(
        [
            "| | campaign | bare | ratio |",
            "| --- | --- | --- | --- |",
            f"| cases per second, {jobs} side by side | {rate:.2f} | {bare_rate:.2f} "
            f"| {rate / bare_rate:.3f} |",
            f"| processor time of a case, s | {each:.4f} | {bare_each:.4f} "
            f"| {each / bare_each:.3f} |",
            f"| the same with start and end of the command, s | {seen.whole / count:.4f} "
            f"| {bare_each:.4f} | {seen.whole / count / bare_each:.3f} |",
            f"| memory of a worker, most, MB | {max(workers):.0f} | | |",
            f"| memory of all, at a tenth of the time and in the end, MB "
            f"| {early:.0f}, {late:.0f} | | {late / early:.3f} |",
        ]
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--engine", default="direct")
    parser.add_argument("--turn", type=float, default=20.0, help="of the campaign, s")
    parser.add_argument("--write", action="store_true", help="put the table into docs/scale.md")
    options = parser.parse_args()
    found = table(
        watched(options.cases, options.jobs, options.engine, options.turn),
        options.cases,
        options.jobs,
    )
    said = (
        f"{options.cases} landings, `--jobs {options.jobs} --engine {options.engine}`, "
        f"CPython {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores:"
    )
    print(f"{said}\n\n{found}")
    if options.write:
        mark = "" if options.engine == "direct" else f", {options.engine}"
        write_measured("scale.md", f"{said}\n\n{found}", f"measured: campaign{mark}")


if __name__ == "__main__":
    main()
