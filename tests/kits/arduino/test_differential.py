"""Sketches made from seeds in both back ends: output and times of the firmware are the reference.

More of them: ``python -m tests.kits.arduino.test_differential FIRST SKETCHES``.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import pytest

from seatrial_kits.arduino.board import EDGE, Event
from seatrial_kits.arduino.component import Arduino
from seatrial_kits.arduino.mcus import CLOCK

from .bench import Bench, write_sketch
from .generated import LEVELS, SLOT_MS, VOLTS, WAVE_HZ, WIRES, sketch

pytestmark = [pytest.mark.interop, pytest.mark.slow]

CASES = 40
NEAR = 2100.0
"""Microseconds by which times differ at most: millis() counts 1.024 ms, at times two; or two edges."""
LATE = 3e-3
"""Seconds by which edges do: a slot begins with millis(), and what code takes is a guess."""
SHARE = 0.02


class Recorded(Arduino):
    """A board whose edges are kept, by pin."""

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self.edges: dict[int, list[tuple[int, float]]] = {}

    def _take(self, events: list[Event]) -> None:
        for kind, pin, level, cycle in events:
            if kind == EDGE:
                edges = self.edges.setdefault(pin, [])
                if level != (edges[-1][0] if edges else 0):
                    edges.append((level, cycle / CLOCK))
        super()._take(events)


def run(place: Path, backend: str) -> tuple[list[list[str]], dict[int, list[tuple[int, float]]]]:
    """Return the words of each case, and the edges of each pin."""
    uarts = "0 115200; 1 38400"
    with Bench(place, backend, board=Recorded, wires=WIRES, uarts=uarts, patience=10.0) as bench:
        for number, level in enumerate(LEVELS.values(), 1):
            bench.one.set(f"level.i{number}", level)
        for number, volts in enumerate(VOLTS.values(), 1):
            bench.one.set(f"voltage.v{number}", volts)
        bench.one.set("wind_speed", WAVE_HZ)
        bench.run(1.75 * SLOT_MS / 1000)  # near the end of a slot, when its case is over
        for _ in range(CASES // 4):
            bench.receive(1, b"42,")
            bench.run(4 * SLOT_MS / 1000)
        bench.run(4 * SLOT_MS / 1000)
        lines = bench.sent[0].decode("latin-1").split("\n#")[1:]
        return [line.split() for line in lines], bench.one.edges


def differences(seed: int, folder: Path) -> list[str]:
    """Return where the two differ, a line each, with the seed of the case."""
    place = write_sketch(folder, sketch(seed, CASES), f"generated{seed}")
    (host, host_edges), (simavr, simavr_edges) = run(place, "host"), run(place, "simavr")
    found = [] if len(host) == len(simavr) == CASES else [f"{seed}: {len(host)}, {len(simavr)}"]
    for case, (ours, theirs) in enumerate(zip(host, simavr, strict=False)):
        same = len(ours) == len(theirs) and all(map(_agree, ours, theirs))
        found += [] if same else [f"{seed + case}: {' '.join(ours)} not {' '.join(theirs)}"]
    for pin in sorted({*host_edges, *simavr_edges}):
        found += _edges(seed, pin, host_edges.get(pin, []), simavr_edges.get(pin, []))
    return found


def _agree(ours: str, theirs: str) -> bool:
    if not ours.startswith("~") or not theirs.startswith("~"):
        return ours == theirs
    a, b = float(ours[1:]), float(theirs[1:])
    return abs(a - b) <= NEAR + SHARE * abs(b)


def _edges(
    seed: int, pin: int, ours: list[tuple[int, float]], theirs: list[tuple[int, float]]
) -> list[str]:
    """Return the cases in which a pin has other edges, or at other times."""
    found = []
    for case in range(CASES):
        begin, end = (SLOT_MS * (case + 1 + more) / 1000 for more in (0, 1))
        a, b = ([e for e in edges if begin <= e[1] < end] for edges in (ours, theirs))
        levels = [level for level, _ in a] == [level for level, _ in b]
        late = [abs(x[1] - y[1]) for x, y in zip(a, b, strict=False)]
        if pin == 6:
            continue  # modulated by hardware: its edges are not the firmware's
        if (pin != 25 and not levels) or abs(len(a) - len(b)) > 3 or max(late, default=0) > LATE:
            found.append(f"{seed + case}: pin {pin} {a[:6]} not {b[:6]}")
    return found


@pytest.mark.parametrize("seed", [0, 40, 80])
def test_a_generated_sketch_is_the_same_in_both_back_ends(tmp_path, seed):
    assert differences(seed, tmp_path) == []


if __name__ == "__main__":
    first, sketches = map(int, sys.argv[1:3])
    for number in range(first, first + sketches):
        with tempfile.TemporaryDirectory() as folder:
            print(
                f"seeds {CASES * number} on", *differences(CASES * number, Path(folder)), sep="\n  "
            )
