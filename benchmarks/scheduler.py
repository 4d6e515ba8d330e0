"""Bounds of a campaign on many cores, measured and modelled: ``python -m benchmarks.scheduler``.

The campaign is the real one but for its cases, which sleep instead of being simulated: the process
that hands them out, its log and its tables, and Dask's scheduler, with workers of this machine that
have so many threads that they stand for a cluster (who sleeps needs no core). Measured are

- the process that hands out cases, alone: cases that end at once, and what the files grow by;
- Dask's scheduler, alone: tasks that do nothing;
- both, with places that sleep: which share of their time they are busy.

A model by events has what was measured as service times, wall time for the comparison and
processor time, as on cores of their own, for what follows: places work on a task, the scheduler and
then the process serve one task at a time, and ``WAITING`` tasks a place are under way. It is
compared with the measured share, and then asked for sizes that this machine does not carry.
``--write`` puts the tables into docs/scale.md.
"""

from __future__ import annotations

import argparse
import heapq
import os
import platform
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.trial.running.measuring import Measured
from seatrial_kits.campaigns import sweep
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.ended import Ended

from .campaign import CAMPAIGN
from .pages import write_measured

TASK_S = 2.0
"""Wall time of a task of short cases, as `seatrial_kits.campaigns.cluster` has it."""
WAITING = 4
"""Tasks under way for each place, as there."""
_VERDICT = {
    "check": "abs(hull.attitude.phi) < 10 deg",
    "passed": True,
    "detail": "",
    "robustness": 0.123456789,
    "worst": 8.7654321,
    "unit": "deg",
    "expected": "pass",
}
_CRITERIA = (
    "roll stays below 10 degrees",
    "pitch stays below 5 degrees",
    "heave settles within 5 seconds of contact",
)


def ended(number: int, wall: float) -> Ended:
    """Return a case that has ended, as large as that of a landing."""
    verdicts: list[dict[str, Any]] = [{"name": name, **_VERDICT} for name in _CRITERIA]
    return Ended(number, Measured("complete", None, 1, verdicts, [], wall), "", "host", time.time())


def asleep(task: Sequence[int], each: float) -> list[Ended]:
    """Sleep for as long as a task's cases take."""
    time.sleep(each * len(task))
    return [ended(number, each) for number in task]


class Sleeping:
    """Stands in for the workers of a campaign: cases sleep, on a Dask cluster or at once."""

    def __init__(self, client: Any, places: int, each: float, batch: int) -> None:
        self._each, self._batch = each, batch
        self.places = WAITING * places
        self._executor = None if client is None else client.get_executor(pure=False)

    def size(self, wall: float) -> int:
        return self._batch

    def submit(self, task: Sequence[int], below: Path) -> Future[Any]:
        if self._executor is not None:
            submitted: Future[Any] = self._executor.submit(asleep, list(task), self._each)
            return submitted
        future: Future[Any] = Future()
        future.set_result([ended(number, self._each) for number in task])
        return future

    def lost(self, error: BaseException) -> bool:
        return False

    def close(self) -> None:
        pass


@dataclass
class Swept:
    """What a campaign came to."""

    wall: float
    """From the first task on, s."""
    processor: float
    """Of this process, s."""
    bytes: dict[str, int]
    """Of each file."""


def swept(count: int, workers: Sleeping) -> Swept:
    """Run a campaign of cases that sleep."""
    real, begun = sweep.Here, [0.0, 0.0]

    def here(*_: Any) -> Any:
        begun[:] = time.perf_counter(), time.process_time()
        return workers

    sizes: dict[str, int] = {}
    with tempfile.TemporaryDirectory(prefix="seatrial-") as place:
        path, out = Path(place, "landings.toml"), Path(place, "out")
        path.write_text(CAMPAIGN.format(count=count), "utf-8")
        sweep.Here = here  # type: ignore[assignment,misc]

        def done(_case: Any, each: Ended) -> None:
            if each.number == count - 1:
                sizes["ended.jsonl"] = (out / "ended.jsonl").stat().st_size

        try:
            sweep.run_sweep(load_campaign(str(path)), out, sweep.How("direct"), done=done)
        finally:
            sweep.Here = real  # type: ignore[misc]
        found = Swept(time.perf_counter() - begun[0], time.process_time() - begun[1], sizes)
        sizes.update((f.name, f.stat().st_size) for f in out.glob("*.parquet"))
    return found


def task_time(client: Any, count: int) -> tuple[float, float]:
    """Return wall and processor time of Dask's scheduler and client for an empty task, s."""
    begun, used = time.perf_counter(), time.process_time()
    client.gather(client.map(int, range(count), pure=False))
    return (time.perf_counter() - begun) / count, (time.process_time() - used) / count


def busy(places: int, task: float, batch: int, times: tuple[float, float], tasks: int) -> float:
    """Return the share of their time that places work, by events.

    A place takes the next task that waits for it, works on it for ``task`` s and hands it to the
    scheduler, which needs ``times[0]`` for it; then the process needs ``times[1]`` for each of its
    ``batch`` cases, and hands out the next task for that place.
    """
    scheduler = process = 0.0
    free = [0.0] * places
    ready = [(0.0, place) for place in range(places) for _ in range(WAITING)]
    heapq.heapify(ready)
    worked = end = 0.0
    for _ in range(tasks):
        at, place = heapq.heappop(ready)
        done = max(at, free[place]) + task
        free[place], worked, end = done, worked + task, max(end, done)
        scheduler = max(scheduler, done) + times[0]
        process = max(process, scheduler) + times[1] * batch
        heapq.heappush(ready, (process, place))
    return worked / (places * end)


@dataclass
class Measurement:
    """Service times and shares, as measured."""

    case: tuple[float, float]
    """Wall and processor time of the process for a case, s."""
    bytes: dict[str, float]
    """Of each file, for a case."""
    task: tuple[float, float]
    """The same of Dask's scheduler for a task, s."""
    places: int
    shares: list[tuple[float, int, float]]
    """Time of a task, its cases, and which share of their time places were busy."""


def measured(count: int, places: int) -> Measurement:
    """Measure on this machine: two worker processes with half of the places each."""
    from distributed import Client, LocalCluster

    alone = swept(count, Sleeping(None, 2, 0.0, 16))
    shares = []
    cluster = LocalCluster(
        n_workers=2, threads_per_worker=places // 2, processes=True, dashboard_address=None
    )
    with cluster, Client(cluster) as client:
        task_time(client, 200)
        task = sorted(task_time(client, 2000) for _ in range(3))[1]
        for batch in (1, 16):
            tasks = 5 * places
            found = swept(tasks * batch, Sleeping(client, places, TASK_S / batch, batch))
            shares.append((TASK_S, batch, tasks * TASK_S / (places * found.wall)))
    sizes = {name: size / count for name, size in alone.bytes.items()}
    return Measurement((alone.wall / count, alone.processor / count), sizes, task, places, shares)


def tables(found: Measurement, case: float) -> str:
    """Return what was measured, and what the model says, in Markdown."""
    walls, processor = ((found.task[which], found.case[which]) for which in (0, 1))
    rows = [
        "| | wall time, ms | processor time, ms |",
        "| --- | --- | --- |",
        "| the process that hands out cases, a case "
        f"| {1e3 * walls[1]:.3f} | {1e3 * processor[1]:.3f} |",
        f"| Dask's scheduler, a task | {1e3 * walls[0]:.3f} | {1e3 * processor[0]:.3f} |",
    ]
    compared = [
        "| places that sleep | time of a task, s | cases in it | busy, measured | busy, model |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {found.places} | {task:g} | {batch} | {share:.2f} "
            f"| {busy(found.places, task, batch, walls, 5 * found.places):.2f} |"
            for task, batch, share in found.shares
        ),
    ]
    return "\n".join([*rows, "", *compared, "", *model(processor, case, found.bytes)])


def model(times: tuple[float, float], case: float, sizes: dict[str, float]) -> list[str]:
    """Return what the model says of 1,000 cores and of the most that are kept busy."""
    batch = max(1, int(TASK_S / case))
    lines = [
        "| cores | cases in a task | busy | cases per second | 10^6 cases | 10^8 cases |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for cores, of in ((100, batch), (1000, batch), (1000, 1), (10_000, batch)):
        share = busy(cores, of * case, of, times, 40 * cores)
        rate = share * cores / case
        often, rarely = lasts(1e6 / rate), lasts(1e8 / rate)
        lines.append(f"| {cores:,} | {of} | {share:.2f} | {rate:,.0f} | {often} | {rarely} |")
    said = ", ".join(f"`{name}` {size:.0f}" for name, size in sizes.items())
    return [*lines, "", f"Bytes of a case: {said}."]


def lasts(seconds: float) -> str:
    """Return a duration as people say it."""
    for unit, size in (("days", 86_400.0), ("h", 3_600.0), ("min", 60.0)):
        if seconds >= size:
            return f"{seconds / size:.1f} {unit}"
    return f"{seconds:.0f} s"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--cases", type=int, default=20_000, help="of the process alone")
    parser.add_argument("--places", type=int, default=500, help="that sleep")
    parser.add_argument("--case", type=float, default=0.13, help="time of a real one, s")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/scale.md")
    options = parser.parse_args()
    text = tables(measured(options.cases, options.places), options.case)
    said = (
        f"`python -m benchmarks.scheduler --places {options.places} --case {options.case:g}`, "
        f"CPython {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores:"
    )
    print(f"{said}\n\n{text}")
    if options.write:
        write_measured("scale.md", f"{said}\n\n{text}", "measured: scheduler")


if __name__ == "__main__":
    main()
