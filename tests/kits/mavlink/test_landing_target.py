"""Reports of a landing pad, read by pymavlink's parser, against SciPy's rotations."""

import math
import socket

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial_kits.mavlink.landing_target import LandingTarget

PERIOD = 0.01


class Bench:
    """A companion, and an autopilot that listens at its port."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.companion, self.step = LandingTarget("companion"), 0
        port = self.listener.getsockname()[1]
        self.companion.set("link", f"tcpout:127.0.0.1:{port}")
        self.companion.set("system_id", 7.0)
        self.companion.setup(0.0)
        self.companion.initialise()
        self.companion.begin()
        self.run(1)  # it connects
        self.listener.settimeout(5.0)
        self.socket, _ = self.listener.accept()
        self.parser = mavlink.MAVLink(None)

    def run(self, steps, **values):
        for name, value in values.items():
            self.companion.set(name, value)
        for _ in range(steps):
            self.companion.advance(self.step * PERIOD, PERIOD)
            self.step += 1

    def received(self):
        self.companion.close()
        data = b""
        while part := self.socket.recv(65536):
            data += part
        return self.parser.parse_buffer(data) or []

    def close(self):
        self.companion.close()
        self.socket.close()
        self.listener.close()


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


def test_a_sight_is_turned_by_the_attitude_of_its_exposure(bench):
    draw = np.random.default_rng(1)
    then, offset = [0.2, -0.1, 2.5], draw.uniform(-1, 1, 3) + np.array([0, 0, 3])
    bench.run(9, attitude=then)
    bench.run(5, attitude=[0.0, 0.0, 2.0])
    exposed = 8 * PERIOD
    bench.run(3, offset=offset.tolist(), exposed=exposed, sight_valid=True, sight_count=1)
    (report,) = [m for m in bench.received() if m.get_type() == "LANDING_TARGET"]
    x, y, z = Rotation.from_euler("ZYX", then[::-1]).inv().apply(offset)
    assert (report.x, report.y, report.z) == pytest.approx((x, y, z), abs=1e-6)
    assert report.distance == pytest.approx(np.linalg.norm(offset), abs=1e-6)
    # Where no position is taken, the autopilot makes (-tan(angle_y), tan(angle_x), 1) of the angles.
    aside = (-math.tan(report.angle_y), math.tan(report.angle_x))
    assert aside == pytest.approx((x / z, y / z), abs=1e-6)
    assert (report.frame, report.position_valid) == (mavlink.MAV_FRAME_BODY_FRD, 1)
    assert report.time_usec == round(1e6 * exposed)
    assert report.get_srcSystem() == 7
    assert report.get_srcComponent() == mavlink.MAV_COMP_ID_ONBOARD_COMPUTER


def test_each_sight_is_sent_once_and_a_lost_one_is_not(bench):
    for count, valid in enumerate((True, True, False, True), 1):
        bench.run(5, offset=[0, 0, 2], sight_valid=valid, sight_count=count - (not valid))
    sent = [m for m in bench.received() if m.get_type() == "LANDING_TARGET"]
    assert len(sent) == bench.companion.get("reports") == 3


def test_it_beats_once_a_second(bench):
    bench.run(349)
    beats = [m for m in bench.received() if m.get_type() == "HEARTBEAT"]
    assert {m.type for m in beats} == {mavlink.MAV_TYPE_ONBOARD_CONTROLLER}
    assert len(beats) in (3, 4)  # the first may have been before the connection


def test_a_link_that_cannot_be_is_refused():
    companion = LandingTarget("companion")
    companion.set("link", "tcpout:192.0.2.1:5762")
    companion.setup(0.0)
    with pytest.raises(InputError, match=r"companion: .*network"):
        companion.initialise()
