"""Cost of a step of the tether: ``python -m benchmarks.tether``.

An implicit step is measured beside one evaluation of the right-hand side that an explicit method
would need, in turn, for some rounds. Ratios are those of one round; the median over the rounds and
their range are shown. ``--write`` puts the table into docs/kits/videoray/tether.md.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np

from seatrial.system.parameters import load_vehicle
from seatrial_kits.videoray.cable.cable import Cable
from seatrial_kits.videoray.cable.cable_shape import static_shape
from seatrial_kits.videoray.cable.cable_solver import Chain, implicit_step
from seatrial_kits.videoray.cable.tether import Tether

from .pages import write_measured

SEGMENTS = (10, 20, 50, 100, 200)
STEP = 0.01


def tether(segments: int) -> Tether:
    """Return the shipped tether, half loose in a current."""
    component = Tether("tether")
    for name, entry in load_vehicle("tether").parameter_set("tether", None).values.items():
        if entry.unit != "mm":
            component.set(name, entry.value)
    component.set("segments", segments)
    component.set("axial_stiffness", 1e5)
    component.set("bottom_position", [30.0, 0.0, 20.0])
    component.set("current", [0.5, 0.0, 0.0])
    component.initialise()
    component.begin()
    return component


def each(work: Callable[[], object], count: int) -> float:
    """Return the wall time of one call, us."""
    begin = time.perf_counter()
    for _ in range(count):
        work()
    return (time.perf_counter() - begin) / count * 1e6


def costs(segments: int, count: int) -> tuple[float, float, float]:
    """Return wall times of a right-hand side, an implicit step and a communication step, us."""
    component = tether(segments)
    cable: Cable = component._cable
    current, chain = np.array([[0.5], [0.0], [0.0]]), Chain(segments - 1)
    v = np.zeros((3, segments + 1))
    x = static_shape(cable, np.zeros(3), np.array([30.0, 0.0, 20.0]), v, current)

    def right_hand_side() -> object:
        return cable.accelerations(cable.forces(x, v, current))

    def step() -> object:
        return implicit_step(cable, chain, x, v, current, STEP)

    def communicate() -> None:
        t = component.now
        component.set("bottom_position", [30.0 + 0.1 * t, 0.0, 20.0])
        component.refresh()
        component.advance(t, STEP)

    return each(right_hand_side, count), each(step, count), each(communicate, count)


def table(rounds: int, count: int) -> str:
    """Return the table in Markdown."""
    lines = [
        "| segments | right-hand side, µs | implicit step, µs | ratio | communication step, µs |",
        "| --- | --- | --- | --- | --- |",
    ]
    for segments in SEGMENTS:
        found = [costs(segments, count) for _ in range(rounds)]
        right, step, whole = (statistics.median(column) for column in zip(*found, strict=True))
        ratios = [b / a for a, b, _ in found]
        ratio = f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
        lines.append(f"| {segments} | {right:.0f} | {step:.0f} | {ratio} | {whole:.0f} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--write", action="store_true", help="put the table into its page")
    options = parser.parse_args()
    text = f"Python {platform.python_version()}, {options.rounds} rounds.\n\n"
    text += table(options.rounds, options.steps)
    print(text)
    if options.write:
        write_measured("kits/videoray/tether.md", text)


if __name__ == "__main__":
    main()
