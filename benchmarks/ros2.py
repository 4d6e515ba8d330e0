"""Cost and latency of the ROS 2 link: ``python -m benchmarks.ros2``.

Cost: two links with ten sensors each, all of which change at 100 Hz, read by a process of its own.
The share is the CPU time of all threads over simulated time. Latency: a process commands a link
that runs in real time; each velocity is the time of the clock of both as it is written. Times
depend on the machine: the time of one addition in a loop is beside them. ``--write`` puts the table
into docs/kits/ros2/ros2.md.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.synchronize import Event

from seatrial.model.component import Component
from seatrial.sim.clock import Pacer
from seatrial_kits.ros2.component import Ros2
from seatrial_kits.ros2.packing import packed
from seatrial_kits.ros2.participant import Participant
from seatrial_kits.ros2.topics import COMMANDED, PUBLISHED, Names

from .pages import addition, write_measured

DOMAIN, PERIOD = 97, 0.01
LINKS = ("left", "right")
SENSORS = {
    "imu": "gyro", "compass": "heading", "fix": "position_n", "velocity": "velocity_n",
    "pressure": "depth", "dvl": "velocity_b", "water_speed": "water_speed",
    "water_depth": "water_depth", "wind": "wind_speed", "temperature": "water_temperature",
}  # fmt: skip
"""Topics that are measured, and the input that moves each."""
VALID = ("depth", "velocity_b", "water_speed", "water_depth", "wind")
ROUNDS, STEPS, SECONDS = 5, 500, 20
TWIST, SCALE = COMMANDED["cmd_vel"], 1e-6
"""Commands, and the velocity of a second, m/s."""


def link(name: str) -> Ros2:
    """Return a link with ten sensors that runs."""
    made = Ros2(name)
    settings = {"namespace": name, "domain": DOMAIN, "simulator": "", "period": PERIOD}
    for key, value in settings.items():
        made.set(key, value)
    for each in VALID:
        made.set(f"{each}_valid", True)
    made.set("roll_pitch", [0.0, 0.0])
    made.set("accelerometer", [0.0, 0.0, -9.81])
    move(made, 0)
    made.initialise()
    made.begin()
    return made


def move(made: Component, k: int) -> None:
    """Change the measurement of every sensor."""
    for port in SENSORS.values():
        value, axes = 0.5 + 1e-4 * k, made.ports[port].size
        made.set(port, value if axes == 1 else [value + n for n in range(axes)])


def read(ready: Event, done: Event) -> None:
    """Read all topics of both links, until it is ``done``."""
    participant = Participant(DOMAIN)
    topics = [PUBLISHED[key] for key in ("clock", "tf", "odometry", *SENSORS)]
    full = {(Names(name, "").full(topic.name), topic.kind) for name in LINKS for topic in topics}
    readers = [participant.reader(name, kind) for name, kind in full]
    ready.set()
    while not done.wait(0.02):
        for each in readers:
            each.take(100)
    participant.close()


def command(ready: Event, done: Event) -> None:
    """Command the first link at 47 Hz by the time, until it is ``done``."""
    participant = Participant(DOMAIN)
    writer = participant.writer(Names(LINKS[0], "").full(TWIST.name), TWIST.kind)
    ready.set()
    while not done.wait(0.0213):
        writer.write(packed(TWIST.kind, {"linear": (SCALE * time.monotonic(), 0.0, 0.0)}))
    participant.close()


@contextmanager
def beside(work: Callable[[Event, Event], None]) -> Iterator[None]:
    """Have a process that does ``work``."""
    context = multiprocessing.get_context("spawn")
    ready, done = context.Event(), context.Event()
    process = context.Process(target=work, args=(ready, done))
    process.start()
    ready.wait(60.0)
    time.sleep(1.0)
    try:
        yield
    finally:
        done.set()
        process.join()


def cost() -> list[float]:
    """Return shares of a core, one for each round."""
    links = [link(name) for name in LINKS]
    k, shares = 0, []
    with beside(read):
        for each in range(ROUNDS + 1):
            begun = time.process_time()
            for _ in range(STEPS):
                k += 1
                for made in links:
                    move(made, k)
                    made.advance((k - 1) * PERIOD, PERIOD)
            if each:  # the first one finds readers and makes what is made once
                shares.append((time.process_time() - begun) / (STEPS * PERIOD))
    for made in links:
        made.close()
    return shares


def latencies() -> tuple[list[float], list[float], list[float]]:
    """Return how late instants are, commands are taken in, and commands act, s, sorted."""
    made, late, taken, acted = link(LINKS[0]), [], [], []
    pending: list[float] = []
    last = time.monotonic()
    with beside(command):
        pacer = Pacer(1.0, "slip")
        pacer.start(0)
        for k in range(round(SECONDS / PERIOD)):
            pacer.keep(round(k * PERIOD * 1e9))
            late.append(time.monotonic() - last - PERIOD)
            last = time.monotonic()
            acted += [time.monotonic() - each for each in pending]  # at this instant
            before = made.get("target_speed")
            made.advance(k * PERIOD, PERIOD)
            now, speed = time.monotonic(), made.get("target_speed")
            pending = [speed / SCALE] if speed not in (before, 0.0) else []
            taken += [now - each for each in pending]
    made.close()
    return sorted(late), sorted(taken), sorted(acted)


def table(shares: list[float], late: list[float], taken: list[float], acted: list[float]) -> str:
    """Return the figures in Markdown."""
    lines = [
        "| | median | range |",
        "| --- | --- | --- |",
        f"| share of a core, 20 sensors at 100 Hz | {statistics.median(shares):.1%} "
        f"| {min(shares):.1%} to {max(shares):.1%} |",
    ]
    for what, found in (
        ("period of 10 ms, longer by", late),
        ("latency until a command is taken in", taken),
        ("latency until a command acts", acted),
    ):
        highest = found[int(0.99 * len(found))]
        middle = statistics.median(found)
        lines.append(f"| {what} | {1e3 * middle:.1f} ms | 99 % within {1e3 * highest:.1f} ms |")
    return "\n".join([*lines, "", f"One addition in a loop takes {1e9 * addition():.0f} ns there."])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--write", action="store_true", help="put the table into docs")
    options = parser.parse_args()
    text = table(cost(), *latencies())
    print(text)
    if options.write:
        write_measured("kits/ros2/ros2.md", text)


if __name__ == "__main__":
    main()
