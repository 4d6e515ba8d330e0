"""Records written in each format that has a writer here, and read back: the same signals.

The records are of logs with gaps, entries out of order and clocks that were set.
"""

from __future__ import annotations

import random
from collections import Counter

import numpy as np
import pynmea2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial.fmi.components.table import table_component
from seatrial.links.text import Inbox
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.records.run_folder import load_run
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import Transmit, decode
from seatrial_kits.can.player import CanPlayer
from seatrial_kits.can.recorded import recorded_frames
from seatrial_kits.can.run_log import BusLog
from seatrial_kits.logs.imported import Wanted, imported, write_run
from seatrial_kits.logs.mcap_file import write_mcap
from seatrial_kits.logs.paired.steady_clock import steady
from seatrial_kits.logs.parquet_file import write_parquet
from seatrial_kits.logs.played import played
from seatrial_kits.logs.ros2_bag import write_ros2_bag
from seatrial_kits.mavlink.tlog import TelemetryLog
from seatrial_kits.nmea.nmea0183.player import Nmea0183Player

NUMBERS = st.floats(-1e6, 1e6)
STEPS = st.lists(st.integers(1, 400), min_size=3, max_size=30)
"""Times between rows, 10 ms each: up to 4 s, gaps among them."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return lambda: tmp_path_factory.mktemp("trip")


def disordered(lines, times, data):
    """Return lines of which some neighbours have changed places.

    These are less than a second apart: further ones are a clock that was set.
    """
    found = list(lines)
    for k in range(0, len(lines) - 1, 3):
        if times[k + 1] - times[k] < 1.0 and data.draw(st.booleans()):
            found[k], found[k + 1] = lines[k + 1], lines[k]
    return found


def record(folder, steps, data):
    """Return the record of a CSV log, imported; its rows are not in order."""
    times = np.cumsum(steps) / 100.0
    values = [[data.draw(NUMBERS) for _ in times] for _ in range(2)]
    rows = zip(times.tolist(), *values, strict=True)
    lines = disordered([",".join(map(repr, row)) for row in rows], times, data)
    (folder / "boat.csv").write_text("time,x [m],depth [m]\n" + "\n".join(lines) + "\n")
    found = imported(steady(read_log(folder / "boat.csv")), Wanted())
    (folder / "run").mkdir()
    write_run(found, folder / "run", "csv")
    run = load_run(folder / "run")
    np.testing.assert_array_equal(run.time, times)
    np.testing.assert_array_equal(run.signals["log.x"], values[0])
    return run


def channel_of(path, name):
    found = steady(read_log(path))
    names = [each for each in found.channels if each.replace("/", ".").strip(".").startswith(name)]
    assert len(names) == 1, list(found.channels)
    return found.channels[names[0]]


def assert_plays(path, channel):
    """Check that a component that plays the log has the channel's values at its times."""
    unit = 'unit = "1"' if channel.unit is None else f'unit = "{channel.unit}"'
    entry = f'x = {{ channel = "{channel.name}", {unit} }}'
    file = path.with_name("played.toml")
    file.write_text(f'log = "{path.name}"\n[play]\n{entry}\n')
    player = table_component(played(file))("boat")
    player.set("beyond", "hold")
    player.setup(0.0)
    player.initialise()
    player.begin()
    since = np.round(channel.time - channel.time[0], 9)
    for time, value in zip(since.tolist(), channel.values.tolist(), strict=True):
        player.advance(time - 0.01, 0.01)
        # Times are whole nanoseconds, between neighbours up to 2e6 apart in 10 ms.
        assert player.get("x") == pytest.approx(value, rel=1e-9, abs=0.2), time
        assert player.get("x_valid")


@pytest.mark.parametrize("kind", ["csv", "mcap", "parquet", "rosbag2"])
@settings(max_examples=10)
@given(steps=STEPS, data=st.data())
def test_a_record_in_each_format(folders, kind, steps, data):
    folder = folders()
    run = record(folder, steps, data)
    path = folder / "exported"
    {
        "csv": lambda: path.write_bytes((run.folder / "signals.csv").read_bytes()),
        "mcap": lambda: write_mcap(run, path),
        "parquet": lambda: write_parquet(run, path),
        "rosbag2": lambda: write_ros2_bag(run, path),
    }[kind]()
    assert format_of(path) == kind
    for name in ("log.x", "log.depth"):
        found = channel_of(path, name)
        # The time of a bag counts from its first message.
        offset = run.time[0] if kind == "rosbag2" else 0.0
        np.testing.assert_allclose(found.time + offset, run.time, rtol=0.0, atol=1e-9)
        np.testing.assert_array_equal(found.values, run.signals[name])
        assert_plays(path, found)


def sent(player, port, length, h=0.05):
    """Return (time, bytes) that a player sends within a length, s."""
    player.setup(0.0)
    player.initialise()
    player.begin()
    box, found = {}, []
    for number in range(int(length / h) + 2):
        player.advance(number * h, h)
        found += Inbox(box).take(player.get(port))
    return [(when / 1e9, data) for when, data in found]


@settings(max_examples=15)
@given(steps=STEPS, data=st.data())
def test_a_bus_through_its_own_log(folders, steps, data):
    """What `canbus` leaves, candump's text and .blf, plays back at the times to a microsecond."""
    folder = folders()
    log, times = BusLog(folder, "can"), np.cumsum(steps) / 100.0
    frames = [
        Frame(data.draw(st.integers(0, 2**29 - 1)), data.draw(st.binary(max_size=8)), True)
        for _ in times
    ]
    for time, frame in zip(times, frames, strict=True):
        log.frame(round(time * 1e9), frame)
    log.close()
    for name in ("can.log", "can.blf"):
        assert [each.frame for each in recorded_frames(folder / name, Counter())] == frames
    lines = (folder / "can.log").read_text().splitlines(keepends=True)
    (folder / "late.log").write_text("".join(disordered(lines, times, data)))
    for name in ("can.log", "can.blf", "late.log"):
        player = CanPlayer("boat")
        player.set("file", str(folder / name))
        found = sent(player, "tx", times[-1] - times[0] + 0.1)
        operations = [(when, op) for when, data in found for op in decode(data)]
        assert [op.frame for _, op in operations if isinstance(op, Transmit)] == frames
        np.testing.assert_allclose([when for when, _ in operations], times - times[0], atol=1e-6)


@settings(max_examples=15)
@given(steps=STEPS, seed=st.integers(0, 1000), data=st.data())
def test_sentences_through_their_text(folders, steps, seed, data):
    folder, times = folders(), np.cumsum(steps) / 100.0
    numbers = random.Random(seed)
    headings = [f"{numbers.random() * 359.0:.1f}" for _ in times]
    lines = [str(pynmea2.HDT("HE", "HDT", (each, "T"))) for each in headings]
    stamped = [f"{1.7e9 + t:.2f} {line}\n" for t, line in zip(times.tolist(), lines, strict=True)]
    (folder / "boat.nmea").write_text("".join(disordered(stamped, times, data)))
    player = Nmea0183Player("boat")
    player.set("file", str(folder / "boat.nmea"))
    found = sent(player, "tx", times[-1] - times[0] + 0.1)
    assert [sentence.decode().strip() for _, sentence in found] == lines
    np.testing.assert_allclose([when for when, _ in found], times - times[0], atol=1e-6)
    log = steady(read_log(folder / "boat.nmea")).channels["HDT.headingT"]
    assert log.values.tolist() == [float(each) for each in headings]


@settings(max_examples=15)
@given(steps=STEPS, data=st.data())
def test_a_vehicle_through_its_telemetry_log(folders, steps, data):
    """Messages that come up to 0.9 s late, and out of order: their times are the vehicle's."""
    folder, boots = folders(), np.cumsum(steps) * 10
    values = [data.draw(st.floats(-3.0, 3.0, width=32)) for _ in boots]
    delays = [data.draw(st.integers(0, 900)) for _ in boots]
    log, boat = TelemetryLog(1_770_249_600_000_000), mavlink.MAVLink(None, 1, 1)
    log.open(folder / "boat.tlog")
    received = sorted(zip(boots.tolist(), values, delays, strict=True), key=lambda m: m[0] + m[2])
    for boot, value, delay in received:
        log.now = (boot + delay) / 1e3
        message = mavlink.MAVLink_attitude_message(boot, 0.0, 0.0, value, 0.0, 0.0, 0.0)
        log.write(message.pack(boat))
    log.close()
    found = steady(read_log(folder / "boat.tlog")).channels["ATTITUDE.yaw"]
    np.testing.assert_allclose(np.diff(found.time), np.diff(boots) / 1e3, atol=1e-9)
    assert found.values.tolist() == values
    # The time 0 is the first reception; the shortest delay is that of the link.
    first = received[0]
    assert found.time[0] == pytest.approx((boots[0] + min(delays) - first[0] - first[2]) / 1e3)
