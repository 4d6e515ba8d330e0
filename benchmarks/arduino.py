"""Speed of sketches on simulated boards: ``python -m benchmarks.arduino``.

Seconds of the sketch's time per second of processor time, the board's program included: Gloria's
autopilot on a board alone that receives HDT and RMC, and in the rig that sails; the median over
rounds and its range. Each round also adds up numbers in a loop, since machines and hours differ.
``--write`` puts the table into docs/kits/arduino/arduino.md.
"""

from __future__ import annotations

import argparse
import platform
import resource
import statistics
from collections.abc import Callable
from pathlib import Path

from seatrial.links.text import encode
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.arduino.component import Arduino

from .pages import addition, write_measured

SKETCH = Path(__file__).parents[1] / "harness/kits/arduino/firmware" / "gloria_autopilot"
STEP_NS = 20_000_000
HEADING = b"$HEHDT,100.0,T*2E\r\n"
FIX = b"$GPRMC,120000.00,A,2251.7200,S,04313.3800,W,3.00,100.0,010126,,,A*6B\r\n"
WIRES = "9 servo 1; 10 servo 2; 11 servo 3; A0 vane 5; 2 anemometer 1; 0x68 mpu6050"

CHOICES = {"vehicle": "gloria", "autopilot": "gloria-sketch", "servos": "pulse", "step": "20 ms"}


def spent() -> float:
    """Return the processor time of this process and of its children that have ended, s."""
    own, children = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def alone(backend: str, seconds: float) -> float:
    """Return the processor time of a board without a boat, s."""
    board = Arduino("mega")
    values = {"backend": backend, "sketch": str(SKETCH), "wires": WIRES}
    values["uarts"] = "0 115200; 1 38400; 2 57600; 3 19200"
    for name, value in values.items():
        board.set(name, value)
    board.set("wind_speed", 6.0)
    begin = spent()
    board.initialise()
    board.begin()
    for k in range(round(seconds * 1e9) // STEP_NS):
        now = k * STEP_NS
        if k % 10 == 0:  # 5 Hz, the fix at 1 Hz
            data = HEADING + (FIX if k % 50 == 0 else b"")
            board.set("rx.uart1", encode(k // 10 + 1, [(now, data)]))
        board.advance(now / 1e9, STEP_NS / 1e9)
    board.close()
    return spent() - begin


def sailing(backend: str, seconds: float) -> float:
    """Return the processor time of Gloria under her sketch, boards and all, in process; s."""
    system = assemble(load_rig("sil", None, CHOICES), "direct")
    system.set("autopilot.main.mega.backend", backend, "this table")
    begin = spent()
    try:
        master = Master(system)
        master.initialise()
        for _ in range(round(seconds * 1e9) // STEP_NS):
            master.step()
    finally:
        system.free()
    return spent() - begin


ROWS: dict[str, tuple[Callable[[str, float], float], str, float]] = {
    "`host`, the board alone": (alone, "host", 60.0),
    "`simavr`, the board alone": (alone, "simavr", 10.0),
    "`host`, the rig that sails": (sailing, "host", 60.0),
    "`simavr`, the rig that sails": (sailing, "simavr", 10.0),
}


def table(rounds: int) -> str:
    """Return the table in Markdown."""
    lines = [
        "| what | times the clock | additions per millisecond of the sketch |",
        "| --- | --- | --- |",
    ]
    for name, (work, backend, seconds) in ROWS.items():
        work(backend, 1.0)  # builds
        found = [(work(backend, seconds) / seconds, addition()) for _ in range(rounds)]
        rates = [1 / share for share, _ in found]
        additions = statistics.median(share * 1e-3 / unit for share, unit in found)
        lines.append(
            f"| {name} | {statistics.median(rates):.1f} ({min(rates):.1f} to {max(rates):.1f}) "
            f"| {additions:,.0f} |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true", help="put the table into its page")
    options = parser.parse_args()
    text = (
        f"Python {platform.python_version()}, {options.rounds} rounds; "
        f"an addition in a loop took {addition() * 1e9:.0f} ns.\n\n{table(options.rounds)}"
    )
    print(text)
    if options.write:
        write_measured("kits/arduino/arduino.md", text)


if __name__ == "__main__":
    main()
