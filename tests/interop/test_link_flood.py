"""A thousand messages a second at a running trial: none is lost, and a core can carry it."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from .running import HOST, RunningTrial, free_port, running, wait_for

RATE = 1000
FLOODER = 77
PING_EVERY = 20
OUTSTANDING = 200
"""Messages without an answer after which it waits: more would overflow a socket's buffer."""
PATIENCE_S = 300.0
"""Wall time for a machine that is busy with something else."""

Frames = list[bytes]


def mixed(number: int) -> Frames:
    """Return so many valid frames: what stations send, and what a vehicle must answer."""
    mav = mavlink.MAVLink(None, FLOODER, 190)
    mav.srcSystem, mav.srcComponent = FLOODER, 190
    frames = []
    for n in range(number):
        frames.append(_message(n).pack(mav))
        mav.seq = (mav.seq + 1) % 256
    return frames


def _message(n: int) -> mavlink.MAVLink_message:
    if n % PING_EVERY == PING_EVERY - 1:
        return mavlink.MAVLink_ping_message(n, n, 0, 0)
    numbers = (mavlink.MAVLINK_MSG_ID_ATTITUDE, mavlink.MAVLINK_MSG_ID_SYS_STATUS, 395)
    request = mavlink.MAV_CMD_REQUEST_MESSAGE
    ignored, here = 0xDF8, (n % 7 * 1.0, 0.0, 0.0)
    kinds = (
        lambda: mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3),
        lambda: mavlink.MAVLink_manual_control_message(1, n % 900, -n % 900, 500, 0, 0),
        lambda: mavlink.MAVLink_rc_channels_override_message(1, 1, *[1500 + n % 300] * 8),
        lambda: mavlink.MAVLink_param_request_read_message(1, 1, b"", n % 100),
        lambda: mavlink.MAVLink_command_long_message(1, 1, request, 0, numbers[n % 3], *[0] * 6),
        lambda: mavlink.MAVLink_timesync_message(0, n),
        lambda: mavlink.MAVLink_mission_request_int_message(1, 1, n % 5, 0),
        lambda: mavlink.MAVLink_set_position_target_local_ned_message(
            n, 1, 1, 1, ignored, *here, *[0.0] * 8
        ),
        lambda: mavlink.MAVLink_param_set_message(1, 1, b"CRUISE_SPEED", 1.0, 9),
        lambda: mavlink.MAVLink_statustext_message(6, b"what nobody here listens to"),
    )
    return kinds[n % len(kinds)]()


def flood(port: int, frames: Frames) -> None:
    """Send all, `RATE` a second or as fast as they are taken."""
    near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    near.connect((HOST, port))
    near.settimeout(0.001)
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    began, sent, answered = time.monotonic(), 0, 0
    while answered < len(frames):
        due = min(len(frames), int((time.monotonic() - began) * RATE), answered + OUTSTANDING)
        for frame in frames[sent:due]:
            near.send(frame)
        sent = max(sent, due)
        assert time.monotonic() - began < PATIENCE_S, f"{answered} of {len(frames)} were answered"
        try:
            while True:
                for m in parser.parse_buffer(near.recv(1 << 16)) or ():
                    if m.get_type() == "PING":
                        answered = m.seq + 1
        except OSError:
            continue
    near.close()


def cpu_s(trial: RunningTrial) -> float:
    """Return the processor time that the process which simulates has taken so far."""
    pid = trial.process.pid
    (simulating,) = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    fields = Path(f"/proc/{simulating}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def share(trial: RunningTrial, clock: Clock, what: Callable[[], object]) -> tuple[float, float]:
    """Return the processor time per simulated time that the trial takes meanwhile, and this."""
    began, before = clock.now(), cpu_s(trial)
    what()
    simulated = clock.now() - began
    return (cpu_s(trial) - before) / simulated, simulated


class Clock:
    """Simulated time, as a link of its own reports it."""

    def __init__(self, port: int) -> None:
        self._link = mavutil.mavlink_connection(f"udpout:{HOST}:{port}", source_system=251)
        self._link.mav.heartbeat_send(6, 8, 0, 0, 4)

    def now(self) -> float:
        """Return the simulated time of the newest attitude, s."""
        self._link.mav.heartbeat_send(6, 8, 0, 0, 4)
        while self._link.recv_msg() is not None:
            pass  # older ones
        received = self._link.recv_match(type="ATTITUDE", blocking=True, timeout=PATIENCE_S)
        return float(received.time_boot_ms) / 1e3


def received(log: Path) -> Iterator[bytes]:
    """Yield the frames of the flood in a telemetry log."""
    reader = mavutil.mavlink_connection(str(log), dialect="all")
    while (message := reader.recv_match()) is not None:
        if message.get_srcSystem() == FLOODER:
            yield bytes(message.get_msgbuf())
    reader.close()


@pytest.mark.parametrize("seconds", [5, pytest.param(60, marks=pytest.mark.long)])
def test_a_flood_is_read_to_the_end(tmp_path: Path, seconds: int) -> None:
    port, frames = free_port(), mixed(RATE * seconds)
    with running(
        "hydrone-mission", tmp_path, autopilot__mavlink__links=f"udpin:{HOST}:{port}"
    ) as trial:
        wait_for(lambda: trial.is_running, "the trial's first step")
        clock = Clock(port)
        idle, _ = share(trial, clock, lambda: wait_for(lambda: clock.now() > 5.0, "5 s"))
        flooded, simulated = share(trial, clock, lambda: flood(port, frames))
        run = trial.stop()
    assert list(received(run.folder / "autopilot.mavlink.tlog")) == frames
    # On a busy machine simulated time falls behind, and more of them come in a second of it.
    each = (flooded - idle) * simulated / len(frames)
    print(
        f"{each * 1e3:.2f} ms of a core for a message; {RATE}/s add {each * RATE:.2f} to {idle:.2f}"
    )
    assert 0.0 < idle + each * RATE < 1.0  # with a core of its own it keeps its pace
