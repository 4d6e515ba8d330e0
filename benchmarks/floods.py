"""Processor time of a step while links are flooded: ``python -m benchmarks.floods``.

A vehicle with MAVLink, NMEA 0183, a serial gateway and a loaded CAN bus with gateways steps by
20 ms in real time, with a program at every link of a kind: first quiet ones, which send once a
second, then some that send as fast as they can. Processor time is that of the simulating process
alone. Run it on an idle core, ``taskset -c 2``: the programs use the others. ``--write`` puts the
table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from seatrial import Simulation

from .pages import write_measured

STEP, SECONDS, ROUNDS = 0.02, 2.0, 3
LIMIT = 1.5
"""Of flooded to quiet."""
RIG = """\
step = "20 ms"
[components]
boat = { rig = "sil", choices = { autopilot = "mavlink" } }
nmea = { fmu = "nmea0183", set = { links = "tcpin:127.0.0.1:0" } }
port = { fmu = "serial-gateway", set = { links = "pty" } }
can = { fmu = "canbus", set = { nodes = "traffic socketcand slcan yd" } }
traffic = { fmu = "can-traffic", set = { messages = "0x0DF80102 0.001 8" } }
socketcand = { fmu = "can-gateway", set = { link = "socketcand:127.0.0.1:0" } }
slcan = { fmu = "can-gateway", set = { link = "slcan-tcp:127.0.0.1:0" } }
yd = { fmu = "can-gateway", set = { link = "yd-raw-tcp:127.0.0.1:0" } }
[connections]
"can.n1" = "traffic.bus"
"can.n2" = "socketcand.bus"
"can.n3" = "slcan.bus"
"can.n4" = "yd.bus"
"""
MAVLINK = "boat.autopilot.mavlink"
WHAT = {
    MAVLINK: "MAVLink, by UDP, TCP and a pseudo-terminal: heartbeats",
    "nmea": "NMEA 0183, by TCP: sentences",
    "port": "serial gateway, at a pseudo-terminal: bytes",
    "socketcand": "CAN gateway, socketcand: frames",
    "slcan": "CAN gateway, slcan: frames",
    "yd": "CAN gateway, YD RAW: frames",
}
_PROGRAM = """
import os, re, socket, sys, time
what, place, pause = sys.argv[1:]
hello, data = b"", b"x" * 2000
if what == "nmea":
    data = b"$GPHDT,274.07,T*03\\r\\n" * 50
elif what == "socketcand":
    hello, data = b"< open can0 >< rawmode >", b"< send 0DF80102 8 1 2 3 4 5 6 7 8 >" * 50
elif what == "slcan":
    hello, data = b"O\\r", b"T0DF8010281122334455667788\\r" * 50
elif what == "yd":
    data = b"0DF80102 11 22 33 44 55 66 77 88\\r\\n" * 50
elif what != "port":
    from pymavlink.dialects.v20 import all as mavlink
    sender = mavlink.MAVLink(None, 255, 190)
    data = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(sender)
    data *= 1 if place.startswith("udp") else 50
if place.startswith("/"):
    line = os.open(place, os.O_RDWR | os.O_NOCTTY)
    send = lambda data: os.write(line, data)
else:
    kind = socket.SOCK_DGRAM if place.startswith("udp") else socket.SOCK_STREAM
    host, port = re.search(r"([\\d.]+):(\\d+)$", place).groups()
    opened = socket.socket(type=kind)
    opened.connect((host, int(port)))
    send = opened.send if kind == socket.SOCK_DGRAM else opened.sendall
if hello:
    send(hello)
while True:
    send(data)
    if float(pause):
        time.sleep(float(pause))
"""


@contextlib.contextmanager
def programs(places: list[tuple[str, str]], pause: float, cores: set[int]) -> Iterator[None]:
    """Have a program at each place, which sends and waits, again and again, on ``cores``."""
    command = [sys.executable, "-c", _PROGRAM]
    started = [
        subprocess.Popen(
            [*command, *place, str(pause)],
            preexec_fn=lambda: os.sched_setaffinity(0, cores),
            stderr=subprocess.DEVNULL,
        )
        for place in places
    ]
    try:
        yield
    finally:
        for program in started:
            program.kill()
            program.wait()


def stepped(simulation: Simulation, seconds: float) -> list[float]:
    """Step in real time; return the processor time of each step, s."""
    taken, begun = [], time.monotonic()
    for number in range(round(seconds / STEP)):
        time.sleep(max(0.0, begun + number * STEP - time.monotonic()))
        before = time.process_time()
        simulation.step()
        taken.append(time.process_time() - before)
    return taken


def measure(chosen: list[str]) -> tuple[list[float], list[float]]:
    """Return the processor times of steps, quiet and flooded at the chosen components."""
    own = os.sched_getaffinity(0)
    others = set(range(os.cpu_count() or 1)) - own or own
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        rig = Path(folder, "rig.toml")
        rig.write_text(RIG, "utf-8")
        links = {f"{MAVLINK}.links": "udpin:127.0.0.1:0 tcpin:127.0.0.1:0 pty"}
        with Simulation(rig, set=links) as simulation:
            at = {name: str(simulation.get(f"{name}.reached_at")).split() for name in chosen}
            places = [(name, place) for name in chosen for place in at[name]]
            found: dict[float, list[float]] = {1.0: [], 0.0: []}
            for _ in range(ROUNDS):
                for pause, taken in found.items():
                    with programs(places, pause, others):
                        stepped(simulation, 1.0)  # they start
                        taken += stepped(simulation, SECONDS)
            return found[1.0], found[0.0]


def main() -> None:
    parser = argparse.ArgumentParser(description="processor time of a step under floods")
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    rows = ["| flood | quiet, ms | flooded, ms | ratio | 99 of 100 steps, ms |", "| --- " * 5 + "|"]
    write = parser.parse_args().write
    for name in (*WHAT, ""):
        quiet, flood = measure([name] if name else list(WHAT))
        a, b = statistics.fmean(quiet), statistics.fmean(flood)
        late = statistics.quantiles(flood, n=100)[98]
        times = f"{a * 1e3:.2f} | {b * 1e3:.2f} | {b / a:.2f} | {late * 1e3:.1f}"
        rows.append(f"| {WHAT.get(name, 'all of them at once')} | {times} |")
        print(rows[-1], flush=True)
    if write:
        write_measured("performance.md", "\n".join(rows), "measured under floods")
    if b / a > LIMIT:
        raise SystemExit(f"the ratio of all of them is {b / a:.2f}, {LIMIT:g} is allowed")


if __name__ == "__main__":
    main()
