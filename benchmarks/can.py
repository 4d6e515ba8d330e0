"""Cost of a frame on the simulated CAN bus: ``python -m benchmarks.can``.

Random data frames of 8 bytes from ten nodes on a bus of 250 kbit/s that is full, in steps of 10 ms:
frames per second of processor time, the median over rounds and its range. Machines differ and so do
the hours of one machine; so each round also adds up numbers in a loop, and the table has how many
such additions a frame costs. ``--write`` puts the table into docs/kits/can/can.md.
"""

from __future__ import annotations

import argparse
import platform
import random
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.can.component import NODES, CanBus
from seatrial_kits.can.controller import Controller
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.simulated_bus import SimulatedBus

from .pages import addition, write_measured

SENDERS = 10
BETWEEN_NS = 550_000
"""Between requests; frames last 524 to 576 us."""
STEP_NS = 10_000_000
RIG = """
step = "10 ms"

[components]
can = {{ fmu = "canbus", set = {{ nodes = "{names}", queue_length = 1000 }} }}
{nodes}

[connections]
{connections}
"""


def frames(count: int) -> list[tuple[int, int, Frame]]:
    """Return (time in ns, node, frame) of requests that fill the bus."""
    rng = random.Random(1)
    return [
        (
            k * BETWEEN_NS,
            k % SENDERS,
            Frame(0x09F10000 + rng.randrange(256), rng.randbytes(8), True),
        )
        for k in range(count)
    ]


def arbitration(count: int) -> float:
    """Return the time of the bus alone: queues, arbitration, lengths, counters; s."""
    bus = SimulatedBus([Controller(str(n), 1000, 3) for n in range(SENDERS)], 250_000, 2_000_000)
    asked = frames(count)
    begin = time.process_time()
    for when, node, frame in asked:
        bus.request(when * 1000, node, frame)
    bus.run(10**18)
    spent = time.process_time() - begin
    assert bus.attempts == count
    return spent


def component(count: int, *, reads: bool, folder: str = "") -> float:
    """Return the time of the component, its nodes asking, and all receiving if wanted; s."""
    bus = CanBus("can")
    bus.set("nodes", " ".join(f"n{n}" for n in range(SENDERS)))
    bus.set("queue_length", 1000.0)
    bus.initialise()
    bus.begin()
    bus.set("run_folder", folder)
    memories: list[dict[str, object]] = [{} for _ in range(SENDERS)]
    asked, place, now, received = frames(count), 0, 0, 0
    begin = time.process_time()
    while bus.get("frames") < count:
        nodes = [CanNode(memory) for memory in memories]
        if reads:
            received += sum(len(node.receive(rx)) for node, rx in zip(nodes, bus.rx, strict=False))
        while place < count and asked[place][0] <= now + STEP_NS:
            when, number, frame = asked[place]
            nodes[number].send(when, frame)
            place += 1
        bus.advance(now / 1e9, STEP_NS / 1e9)
        bus.set("tx", [node.flush() for node in nodes] + [""] * (NODES - SENDERS))
        now += STEP_NS
    bus.close()
    spent = time.process_time() - begin
    assert received >= (count - 40) * SENDERS * reads
    return spent


def rig(count: int, engine: str) -> float:
    """Return the time of a rig of ``can-traffic`` and ``canbus``, in process or as FMUs; s."""
    names = [f"n{n + 1}" for n in range(SENDERS)]
    each = [
        f'{n} = {{ fmu = "can-traffic", set = {{ load = 0.1, background = "0x09F1{k:04X}" }} }}'
        for k, n in enumerate(names)
    ]
    connections = [f'"{n}.tx" = "can.tx.{n}"\n"can.rx.{n}" = "{n}.rx"' for n in names]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "rig.toml")
        path.write_text(
            RIG.format(
                names=" ".join(names), nodes="\n".join(each), connections="\n".join(connections)
            ),
            "utf-8",
        )
        system = assemble(load_rig(str(path)), engine)
        try:
            master = Master(system)
            master.initialise()
            begin = time.process_time()
            for _ in range(count * BETWEEN_NS // STEP_NS):
                master.step()
            spent = time.process_time() - begin
            sent = master.signals[master.names.index(("can", "frames"))]
        finally:
            system.free()
    return spent * count / float(sent)


def logged(count: int) -> float:
    """Return the time of the component with its logs, s."""
    with tempfile.TemporaryDirectory() as folder:
        return component(count, reads=True, folder=folder)


ROWS: dict[str, Callable[[int], float]] = {
    "arbitration alone": arbitration,
    "the component; nodes ask": lambda count: component(count, reads=False),
    "the component; nodes request, and receive all": lambda count: component(count, reads=True),
    "the same, with logs": logged,
    "a rig of ten `can-traffic`, in process": lambda count: rig(count, "direct"),
    "the same as FMUs": lambda count: rig(count, "fmu"),
}


def table(rounds: int, count: int) -> str:
    """Return the table in Markdown."""
    lines = [
        "| what | frames per second | times a full bus of 250 kbit/s | additions per frame |",
        "| --- | --- | --- | --- |",
    ]
    for name, work in ROWS.items():
        found = [(work(count) / count, addition()) for _ in range(rounds)]
        rates = [1 / spent for spent, _ in found]
        rate = statistics.median(rates)
        additions = statistics.median(spent / unit for spent, unit in found)
        lines.append(
            f"| {name} | {rate:,.0f} ({min(rates):,.0f} to {max(rates):,.0f}) "
            f"| {rate * BETWEEN_NS / 1e9:.1f} | {additions:,.0f} |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--frames", type=int, default=10_000)
    parser.add_argument("--write", action="store_true", help="write docs/kits/can/can.md")
    options = parser.parse_args()
    unit = addition() * 1e9
    text = (
        f"Python {platform.python_version()}, {options.rounds} rounds of {options.frames} frames; "
        f"an addition in a loop took {unit:.0f} ns.\n\n"
    )
    text += table(options.rounds, options.frames)
    print(text)
    if options.write:
        write_measured("kits/can/can.md", text)


if __name__ == "__main__":
    main()
