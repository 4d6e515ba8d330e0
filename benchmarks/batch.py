"""Copies in one program against single compiled runs, and loops of environments: ratios of one run.

``python -m benchmarks.batch`` prints processor times; equal bytes show that all did the same.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import seatrial

_RIG = "landing"
_STEPS = 200
_ENVIRONMENT = 10
"""Communication steps of 10 ms between two observations."""


def _spent(act: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    begun = clock()
    act()
    return clock() - begun


def _single() -> float:
    """Return the processor time of a step of a single compiled run without a record, s."""
    with seatrial.Simulation(_RIG, engine="native") as one:
        one.step(_STEPS)
        return min(_spent(lambda: one.step(_STEPS)) for _ in range(5)) / _STEPS


def _environment() -> tuple[float, list[str]]:
    """Return the time of an environment's step over `Simulation`, s, and what it observes."""
    with seatrial.Simulation(_RIG, engine="native") as one:
        names = [name for name, each in one.signals.items() if each.type is not str]
        sensors = [name for name in names if name.startswith(("vehicle.gnss", "vehicle.imu"))]

        def act() -> None:
            for _ in range(20):
                one.override("autopilot.keeper.pulse_port", 1.55e-3)
                one.step(_ENVIRONMENT)
                _ = [one.get(name) for name in sensors]

        act()
        return min(_spent(act) for _ in range(3)) / 20, sensors


def _batch(
    count: int, names: list[str], steps: int, threads: int = 1, *, acts: bool = False
) -> tuple[float, float]:
    """Return processor and wall time of a step of one copy, all observed after ``steps``, s."""
    with seatrial.Batch(_RIG, count, threads=threads) as batch:
        rounds = max(1, _STEPS // steps)

        def act() -> None:
            for _ in range(rounds):
                if acts:
                    batch.override("autopilot.keeper.pulse_port", 1.55e-3)
                batch.step(steps)
                batch.get(*names)

        act()
        times = [
            (_spent(act), _spent(act, time.perf_counter)) for _ in range(2 if count > 500 else 4)
        ]
        shares = count * rounds * steps
        return min(t for t, _ in times) / shares, min(t for _, t in times) / shares


def _weather() -> tuple[float, float, float]:
    """Return the time of a step of one copy in calm water and in waves, and of a start there, s."""
    steps = []
    for trial in ("hydrone-landing", "hydrone-landing-waves"):
        with seatrial.Batch(trial, 64) as batch:
            batch.step(2000)  # by then the headings at which waves are met are tabulated
            steps.append(min(_spent(lambda: batch.step(_STEPS)) for _ in range(5)) / 64 / _STEPS)
            start = _spent(lambda: batch.reset(seed=1000)) / 64
    return steps[0], steps[1], start


def main() -> None:
    """Print the table."""
    single, (loop, sensors) = _single(), _environment()
    print(f"single compiled run: {single * 1e6:.2f} us a step")
    print(f"environment over Simulation: {loop * 1e6:.0f} us for {_ENVIRONMENT} steps")
    hull = [f"vehicle.hull.{name}" for name in ("position", "attitude", "velocity")]
    for count in (1, 64, 256, 1024):
        own, _ = _batch(count, [*hull, *sensors], 1)
        ratio = own / single
        print(f"{count:5d} copies, step(1), all observed: {own * 1e6:.2f} us, {ratio:.2f} single")
    own, _ = _batch(256, sensors, _ENVIRONMENT, acts=True)
    print(f"environment in a batch of 256: {loop / (own * _ENVIRONMENT):.1f} times as fast")
    one, wall = _batch(256, sensors, _ENVIRONMENT)
    two, shared = _batch(256, sensors, _ENVIRONMENT, threads=2)
    print(f"2 threads: processor time {two / one:.2f}, wall {wall / shared:.2f} times as fast")
    calm, waves, start = _weather()
    print(f"in waves, current and gusts: {waves / calm:.2f} of calm water ({calm * 1e6:.2f} us)")
    print(f"start of a copy with another sea: {start * 1e3:.1f} ms")
    copies = 256
    before = _resident()
    with seatrial.Batch(_RIG, copies):
        print(f"memory of a copy: {(_resident() - before) / copies / 1e3:.0f} kB")


def _resident() -> float:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * 4096.0


if __name__ == "__main__":
    main()
