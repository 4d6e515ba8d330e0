"""Cost and latency of the ROS 2 link: ``python -m benchmarks.ros2``.

Cost: two links with ten sensors each, all of which change at 100 Hz, read by a process of its own.
The share is the CPU time of all threads over simulated time. Latency: a process commands a link of
a trial in real time, and another one notes when each command is received; a component behind the
link notes the wall time at which the step with the command begins. Times depend on the machine: the
time of one addition in a loop is beside them. ``--write`` puts the table into
docs/kits/ros2/ros2.md.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

import seatrial
from seatrial.model.component import Component
from seatrial_kits.ros2.component import Ros2
from seatrial_kits.ros2.dds.participant import Participant
from seatrial_kits.ros2.joining import join
from seatrial_kits.ros2.messages.packing import packed
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
TWIST = COMMANDED["cmd_vel"]
PROBE = '''
import time
from seatrial.model.component import Component, Input, Output

class Probe(Component):
    """The speed with which each step is taken, and the wall time at which it begins, s."""
    discrete = True
    speed = Input("m/s", "speed along the bow")
    used = Output("m/s", "the speed of the last step")
    begun = Output("s", "wall time at its beginning")

    def start(self, t):
        self._used = self._begun = 0.0

    def step(self, t, h):
        self._used, self._begun = self.speed, time.monotonic()

    def outputs(self, t):
        self.used, self.begun = self._used, self._begun
'''
RIG = """
step = "%(period)s s"
[components]
probe = { fmu = "probe.py:Probe" }
link = { fmu = "ros2", set = { namespace = "left", domain = %(domain)d, period = "%(period)s s" } }
[connections]
"link.target_speed" = "probe.speed"
"probe.used" = "link.water_speed"
"""
TRIAL = """
rig = "rig.toml"
stop = "%(seconds)d s"
[record]
signals = ["probe.*"]
[real_time]
overrun = "slip"
"""


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
    participant = join(DOMAIN, "/bench", "dds")
    topics = [PUBLISHED[key] for key in ("clock", "tf", "odometry", *SENSORS)]
    full = {(Names(name, "").full(topic.name), topic.kind) for name in LINKS for topic in topics}
    readers = [participant.reader(name, kind) for name, kind in full]
    ready.set()
    while not done.wait(0.02):
        for each in readers:
            each.take(100)
    participant.close()


def command(ready: Event, done: Event, domain: int, interval: float) -> None:
    """Command the first link by growing velocities, until it is ``done``."""
    participant = join(domain, "/bench", "dds")
    writer = participant.writer(Names(LINKS[0], "").full(TWIST.name), TWIST.kind)
    ready.set()
    sent = 0
    while not done.wait(interval):
        sent += 1
        writer.write(packed(TWIST.kind, {"linear": (1e-3 * sent, 0.0, 0.0)}))
    participant.close()


def witness(ready: Event, done: Event, domain: int, received: Queue[Any]) -> None:
    """Note at which wall time each velocity is received, until it is ``done``."""
    from cyclonedds.core import ReadCondition, SampleState, ViewState, WaitSet
    from cyclonedds.util import duration

    participant = Participant(domain)
    reader = participant.reader(Names(LINKS[0], "").full(TWIST.name), TWIST.kind)
    waiting, found = WaitSet(participant.dds), {}
    waiting.attach(ReadCondition(reader.dds, SampleState.NotRead | ViewState.Any))
    ready.set()
    while not done.is_set():
        waiting.wait(duration(milliseconds=100))
        now = time.monotonic()
        for each in reader.take(100):
            found[float(each.message.linear.x)] = now
    received.put(found)
    participant.close()


@contextmanager
def beside(work: Callable[..., None], *more: Any) -> Iterator[None]:
    """Have a process that does ``work``."""
    context = multiprocessing.get_context("spawn")
    ready, done = context.Event(), context.Event()
    process = context.Process(target=work, args=(ready, done, *more))
    process.start()
    ready.wait(60.0)
    time.sleep(1.0)
    try:
        yield
    finally:
        done.set()
        process.join(10.0)


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


def latencies(
    seconds: int = SECONDS, period: float = PERIOD, domain: int = DOMAIN
) -> tuple[list[float], list[float]]:
    """Return how long steps last, and until each command acts in shares of its step, sorted.

    The share is the time from its reception to the step that uses it, over the wall time from the
    step before to that step: 1 of the period, unless the machine is late.
    """
    received: Queue[Any] = multiprocessing.get_context("spawn").Queue()
    with tempfile.TemporaryDirectory() as name, beside(witness, domain, received):
        folder, given = Path(name), {"domain": domain, "period": period, "seconds": seconds}
        for file, text in {"probe.py": PROBE, "rig.toml": RIG, "trial.toml": TRIAL}.items():
            (folder / file).write_text(text % given)
        run = [sys.executable, "-m", "seatrial", "run", "trial.toml", "--engine", "direct"]
        with beside(command, domain, 2.13 * period):
            subprocess.run([*run, "--out", "out"], cwd=folder, check=True, capture_output=True)
        result = seatrial.load_result(folder / "out")
        used, begun = (result.signals[f"probe.{each}"].tolist() for each in ("used", "begun"))
    came = received.get(timeout=10.0)
    lengths, shares = [], []
    for k in range(2, len(used)):
        length = begun[k] - begun[k - 1]
        lengths.append(length)
        if used[k] != used[k - 1] and used[k] in came:
            shares.append((begun[k] - came[used[k]]) / length)
    return sorted(lengths), sorted(shares)


def table(shares: list[float], lengths: list[float], acted: list[float]) -> str:
    """Return the figures in Markdown."""
    length, latency = statistics.median(lengths), statistics.median(acted)
    longest, latest = (found[int(0.99 * len(found))] for found in (lengths, acted))
    return f"""| | median | range |
| --- | --- | --- |
| share of a core, 20 sensors at 100 Hz | {statistics.median(shares):.1%} \
| {min(shares):.1%} to {max(shares):.1%} |
| step of 10 ms lasts | {1e3 * length:.1f} ms | 99 % within {1e3 * longest:.1f} ms |
| from reception of a command to the step that uses it, in steps | {latency:.2f} \
| 99 % within {latest:.2f} |

One addition in a loop takes {1e9 * addition():.0f} ns there."""


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
