"""The component, against pymavlink's own connections on the loopback device."""

import hashlib
import itertools
import math
import socket
import time

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError, SimulationError
from seatrial.system.profile.profile import load_profile
from seatrial_kits.mavlink.component import Mavlink
from seatrial_kits.mavlink.transport import EndpointTransport

WAIT_S = 10.0
KEY = hashlib.sha256(b"correct horse").digest()


MEASURED = {
    "position_n": [0.0, 0.0, 0.0],
    "velocity_n": [0.0, 0.0, 0.0],
    "position_valid": True,
    "heading": 0.0,
    "roll_pitch": [0.0, 0.0],
    "gyro": [0.0, 0.0, 0.0],
    "accelerometer": [0.0, 0.0, -9.81],
}
"""Sensors of a boat, as they are connected in a rig."""


def made(**values):
    component = Mavlink("link")
    for name, value in {**MEASURED, "links": "udpin:127.0.0.1:0", **values}.items():
        if value is not None:
            component.set(name, value)
    return component


@pytest.fixture
def started():
    """Return a function that starts a component, closed after the test."""
    components = []

    def start(**values):
        components.append(made(**values))
        components[-1].initialise()
        components[-1].begin()
        return components[-1]

    yield start
    for component in components:
        component.close()


@pytest.fixture
def connect():
    """Return a function that connects a ground station to a URL of a component."""
    connections = []

    def to(url, system=255):
        kind, _, place = url.partition(":")
        there = {"udpin": f"udpout:{place}", "tcpin": f"tcp:{place}"}[kind]
        connections.append(mavutil.mavlink_connection(there, source_system=system))
        connections[-1].mav.heartbeat_send(6, 8, 0, 0, 4)
        return connections[-1]

    yield to
    for connection in connections:
        connection.close()


def steps(component):
    """Step by 10 ms, for ever."""
    for k in itertools.count(round(component.now * 100)):
        component.advance(k / 100, 0.01)
        yield


def until(component, wanted):
    """Step until ``wanted()`` gives something, and return it; sockets take real time."""
    deadline = time.monotonic() + WAIT_S
    for _ in steps(component):
        found = wanted()
        if found:
            return found
        assert time.monotonic() < deadline, "nothing came"
        time.sleep(0.0002)
    return None


def received(component, station, kind, accept=lambda m: True):
    """Step until the ground station receives such a message, and return it."""

    def found():
        message = station.recv_match(type=kind)
        return message if message is not None and accept(message) else None

    return until(component, found)


@pytest.mark.parametrize("link", ["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0"])
def test_a_ground_station_sees_arms_and_drives_it(started, connect, link):
    boat = started(links=link)
    station = connect(boat.urls[0])
    heartbeat = received(boat, station, "HEARTBEAT")
    assert (heartbeat.type, heartbeat.autopilot) == (11, 3)
    assert station.target_system == 1
    station.mav.command_long_send(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    assert received(boat, station, "COMMAND_ACK").result == mavlink.MAV_RESULT_ACCEPTED
    station.set_mode("MANUAL")
    until(boat, lambda: boat.get("mode") == "manual")
    assert boat.get("armed")
    station.mav.manual_control_send(1, 0, 250, 500, 0, 0)
    until(boat, lambda: boat.get("manual") == [0.5, 0.0, 0.25, 0.0])
    station.mav.command_long_send(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0)
    until(boat, lambda: not boat.get("armed"))
    assert boat.get("manual") == [0.0] * 4


def test_it_calls_a_ground_station_that_listens(started):
    station = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    try:
        port = station.port.getsockname()[1]
        boat = started(links=f"udpout:127.0.0.1:{port}")
        assert received(boat, station, "HEARTBEAT").get_srcSystem() == 1
        station.mav.heartbeat_send(6, 8, 0, 0, 4)
        until(boat, lambda: boat.get("ground_stations") == 1)
    finally:
        station.close()


def test_two_ground_stations_at_once(started, connect):
    boat = started(links="udpin:127.0.0.1:0 tcpin:127.0.0.1:0")
    one, other = connect(boat.urls[0], 255), connect(boat.urls[1], 250)
    until(boat, lambda: boat.get("ground_stations") == 2)
    one.mav.command_long_send(1, 1, 519, 0, 1, 0, 0, 0, 0, 0, 0)
    other.mav.command_long_send(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0)
    assert received(boat, one, "COMMAND_ACK").command == 519
    assert received(boat, other, "AUTOPILOT_VERSION")
    assert received(boat, other, "COMMAND_ACK").command == 512
    # No frame is lost on the way to either.
    assert (one.mav_loss, other.mav_loss) == (0, 0)


def test_a_second_ground_station_on_the_same_endpoint_loses_nothing(started, connect):
    boat = started()
    one, other = connect(boat.urls[0], 255), connect(boat.urls[0], 250)
    until(boat, lambda: boat.get("ground_stations") == 2)
    for _ in range(20):
        one.mav.command_long_send(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0)
        assert received(boat, one, "AUTOPILOT_VERSION")
    received(boat, other, "HEARTBEAT")
    assert (one.mav_loss, other.mav_loss) == (0, 0)


def test_guided_set_points_come_out_at_ports(started, connect):
    boat = started()
    boat.set("heading", math.pi / 2)
    station = connect(boat.urls[0])
    station.mav.set_mode_send(1, 1, 15)
    until(boat, lambda: boat.get("mode") == "guided")
    assert not boat.get("target_valid")
    station.mav.set_position_target_local_ned_send(
        0, 1, 1, 8, 0xDC7, 0, 0, 0, 0.6, 0, 0, 0, 0, 0, 0, 0
    )
    until(boat, lambda: boat.get("target_valid"))
    assert boat.get("target_kind") == "velocity"
    assert boat.get("target_velocity") == pytest.approx([0.0, 0.6, 0.0], abs=1e-6)
    for _ in itertools.islice(steps(boat), 310):
        pass
    assert not boat.get("target_valid")
    station.mav.command_long_send(1, 1, 179, 0, 0, 0, 0, 0, 0.001, 0.002, 0)
    until(boat, lambda: boat.get("home")[0] != 0.0)
    # 0.001 and 0.002 degrees from where the equator meets Greenwich.
    assert boat.get("home") == pytest.approx([110.574, 222.639, 0.0], abs=0.01)


def test_a_submarines_depth_is_its_altitude_and_its_pressure(started, connect):
    rov = started(vehicle_type="submarine")
    rov.set("position_n", [0.0, 0.0, 4.0])
    rov.set("depth", 20.0)
    station = connect(rov.urls[0])
    assert received(rov, station, "GLOBAL_POSITION_INT").relative_alt == -4000
    assert received(rov, station, "ALTITUDE").altitude_local == -4.0
    rov.set("depth_valid", True)
    # Two technical atmospheres of 980.665 hPa on top of a standard one.
    assert received(rov, station, "SCALED_PRESSURE2").press_abs == pytest.approx(2974.58)
    assert (
        received(rov, station, "ALTITUDE", lambda m: m.altitude_local != -4.0).altitude_local
        == -20.0
    )


def test_a_boats_depth_does_not_lower_it(started, connect):
    boat = started(depth=20.0, depth_valid=True)
    station = connect(boat.urls[0])
    assert received(boat, station, "ALTITUDE").altitude_local == 0.0


def test_attitude_is_roll_pitch_and_heading(started, connect):
    boat = started(roll_pitch=[0.1, -0.2], heading=1.5, gyro=[0.3, 0.4, 0.5])
    m = received(boat, connect(boat.urls[0]), "ATTITUDE")
    assert (m.roll, m.pitch, m.yaw) == pytest.approx((0.1, -0.2, 1.5))
    assert (m.rollspeed, m.pitchspeed, m.yawspeed) == pytest.approx((0.3, 0.4, 0.5))


BIT = {
    name: getattr(mavlink, f"MAV_SYS_STATUS_{name}")
    for name in ("SENSOR_3D_GYRO", "SENSOR_3D_ACCEL", "SENSOR_3D_MAG", "SENSOR_GPS")
}
ABSENT = [
    ("gyro", "SENSOR_3D_GYRO", {"RAW_IMU", "SCALED_IMU"}, {"ATTITUDE": ("rollspeed", "pitchspeed", "yawspeed")}),
    ("accelerometer", "SENSOR_3D_ACCEL", {"RAW_IMU", "SCALED_IMU", "VIBRATION"}, {}),
    ("heading", "SENSOR_3D_MAG", {"ATTITUDE_QUATERNION"}, {"ATTITUDE": ("yaw",), "AHRS2": ("yaw",)}),
    ("roll_pitch", None, {"ATTITUDE_QUATERNION"}, {"ATTITUDE": ("roll", "pitch")}),
    ("velocity_n", None, set(), {"LOCAL_POSITION_NED": ("vx", "vy", "vz"), "VFR_HUD": ("groundspeed", "climb", "airspeed")}),
    ("position_n", "SENSOR_GPS", {"GPS_RAW_INT", "GLOBAL_POSITION_INT", "LOCAL_POSITION_NED", "AHRS2", "ALTITUDE"}, {"VFR_HUD": ("alt",)}),
]  # fmt: skip


@pytest.mark.parametrize(("lacking", "bit", "silent", "unknown"), ABSENT)
def test_what_nothing_is_connected_to_is_no_measurement(
    lacking, bit, silent, unknown, started, connect
):
    """Flags of validity are those that a rig has which connects them and not the value."""
    values = {name: value for name, value in MEASURED.items() if name != lacking}
    boat = started(**{lacking: None}, **values)
    station, last = connect(boat.urls[0]), {}

    def all_came():
        while (message := station.recv_match()) is not None:
            last[message.get_type()] = message
        return {"SYS_STATUS", "VFR_HUD", "ATTITUDE", "SYSTEM_TIME"} <= set(last) and boat.now > 2.0

    until(boat, all_came)
    status = last["SYS_STATUS"]
    for name, one in BIT.items():
        for field in ("present", "enabled", "health"):
            assert bool(getattr(status, f"onboard_control_sensors_{field}") & one) == (name != bit)
    assert not silent & set(last)
    for kind, fields in unknown.items():
        message = last[kind]
        for field in message.get_fieldnames():
            given = getattr(message, field)
            assert (isinstance(given, float) and math.isnan(given)) == (field in fields), field
    if lacking == "velocity_n":
        assert (last["GPS_RAW_INT"].vel, last["GLOBAL_POSITION_INT"].vx) == (0xFFFF, 0x7FFF)
    if lacking == "heading":
        assert (last["GLOBAL_POSITION_INT"].hdg, last["VFR_HUD"].heading) == (0xFFFF, 0x7FFF)
    measured = {"gyro": 0x7, "accelerometer": 0x38}.get(lacking, 0x3F)
    assert last["HIGHRES_IMU"].fields_updated == measured


def test_truth_goes_out_beside_the_estimates(started, connect):
    boat = started(truth="on")
    boat.set("position_n", [1.0, 2.0, 3.0])
    boat.set("true_position", [0.0, 0.0, 4.0])
    boat.set("true_attitude", [math.pi / 2, 0.0, 0.0])
    boat.set("true_velocity", [1.0, 2.0, 0.0])
    station = connect(boat.urls[0])
    truth = received(boat, station, "SIM_STATE")
    assert (truth.lat_int, truth.alt) == (0, -4.0)
    # On its starboard side, what is abeam points down, and the weight acts to starboard.
    assert (truth.vn, truth.vd) == (pytest.approx(1.0), pytest.approx(2.0))
    assert (truth.yacc, truth.zacc) == (pytest.approx(-9.81), pytest.approx(0.0, abs=1e-6))
    assert received(boat, station, "LOCAL_POSITION_NED").z == 3.0


def test_named_values_and_battery_come_from_ports(started, connect):
    boat = started(names="rudder sail")
    boat.set("named", [0.25, -0.5, 9, 9, 9, 9, 9, 9])
    boat.set("voltage", 15.5)
    station = connect(boat.urls[0])
    assert received(boat, station, "NAMED_VALUE_FLOAT", lambda m: m.name == "sail").value == -0.5
    assert received(boat, station, "BATTERY_STATUS").voltages[0] == 15500


def test_signatures(started, connect, tmp_path):
    key = tmp_path / "key"
    key.write_text("correct horse\n")
    state = tmp_path / "state.json"
    boat = started(signing_key_file=str(key), state_file=str(state))
    stranger, owner = connect(boat.urls[0], 250), connect(boat.urls[0], 255)
    owner.setup_signing(KEY, sign_outgoing=True)
    owner.mav.heartbeat_send(6, 8, 0, 0, 4)
    until(boat, lambda: boat.get("ground_stations") == 1)  # presence needs one too
    arm = (1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    for station in (stranger, owner):
        # The key cannot be changed over a link, not even by a station that knows it.
        station.mav.setup_signing_send(1, 1, list(range(32)), 0)
    stranger.mav.command_long_send(*arm)
    for _ in itertools.islice(steps(boat), 50):
        time.sleep(0.001)
    assert not boat.get("armed")
    owner.mav.command_long_send(*arm)
    until(boat, lambda: boat.get("armed"))
    assert received(boat, owner, "COMMAND_ACK")._signed
    boat.close()
    assert "signing_timestamp" in state.read_text()


def signed(started, tmp_path, **values):
    key, state = tmp_path / "key", tmp_path / "state.json"
    key.write_text("correct horse\n")
    return started(signing_key_file=str(key), state_file=str(state), **values)


def test_heartbeats_that_are_not_the_owners_hold_off_no_failsafe(started, connect, tmp_path):
    boat = signed(started, tmp_path, station_timeout=0.3)
    owner, stranger, forger = (connect(boat.urls[0]) for _ in range(3))
    owner.setup_signing(KEY, sign_outgoing=True)
    forger.setup_signing(bytes(32), sign_outgoing=True)
    owner.mav.heartbeat_send(6, 8, 0, 0, 4)
    until(boat, lambda: boat.get("ground_stations") == 1)

    def lost():
        for station in (stranger, forger):
            station.mav.heartbeat_send(6, 8, 0, 0, 4)
        return boat.get("failsafe_active")

    until(boat, lost)
    assert boat.get("ground_stations") == 0


@pytest.mark.parametrize("url", ["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0"])
def test_telemetry_of_a_vehicle_that_signs_is_its_owners(url, started, connect, tmp_path):
    boat = signed(started, tmp_path, links=url)
    owner, stranger = connect(boat.urls[0]), connect(boat.urls[0])
    owner.setup_signing(KEY, sign_outgoing=True)
    owner.mav.heartbeat_send(6, 8, 0, 0, 4)
    for _ in range(20):
        received(boat, owner, "ATTITUDE")
        stranger.mav.heartbeat_send(6, 8, 0, 0, 4)
    assert stranger.recv_match() is None


def test_telemetry_goes_to_senders_of_messages_and_to_who_connects(started, connect):
    boat = started(links="udpin:127.0.0.1:0 tcpin:127.0.0.1:0")
    listening = connect(boat.urls[1])
    received(boat, listening, "ATTITUDE")
    talking = connect(boat.urls[0])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as noise:
        noise.setblocking(False)
        noise.sendto(b"no message", ("127.0.0.1", int(boat.urls[0].rpartition(":")[2])))
        for _ in range(20):
            received(boat, talking, "ATTITUDE")
        with pytest.raises(BlockingIOError):
            noise.recv(1000)


def test_a_run_without_anybody_is_the_same_each_time(started):
    def run(**values):
        boat = started(**values)
        outputs = [p.name for p in boat.ports.values() if p.kind == "output"]
        outputs.remove("reached_at")  # ports that the system chose
        return [[boat.get(n) for n in outputs] for _ in itertools.islice(steps(boat), 1000)]

    assert run() == run(links="tcpin:127.0.0.1:0 udpin:127.0.0.1:0") == run(links="")


def test_times_count_from_the_start_of_the_run(started, connect):
    boat = made(date="2026-02-05")
    boat.setup(-1000.0)
    boat.initialise()
    boat.begin()
    try:
        station = connect(boat.urls[0])
        clock = received(boat, station, "SYSTEM_TIME")
        assert clock.time_boot_ms < 60_000
        midnight = 1_770_249_600  # 2026-02-05 00:00 UTC, Unix time
        assert clock.time_unix_usec == midnight * 10**6 + clock.time_boot_ms * 1000
    finally:
        boat.close()


def test_it_cannot_be_rolled_back(started):
    with pytest.raises(SimulationError, match="reaches outside the simulation"):
        started().get_state()


def test_closed_it_gives_its_ports_back(started):
    first = started(links="udpin:127.0.0.1:0 tcpin:127.0.0.1:0")
    links = " ".join(first.urls)
    with pytest.raises(InputError, match=r"link: links: cannot open the link 'udpin:.*in use"):
        started(links=links)
    first.close()
    first.close()
    assert started(links=links).urls == links.split()


def test_a_parameter_set_late_opens_the_links_again(started):
    boat = made()
    boat.initialise()
    try:
        boat.set("links", "tcpin:127.0.0.1:0")
        boat.get("armed")
        assert [url.partition(":")[0] for url in boat.urls] == ["tcpin"]
    finally:
        boat.close()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"links": "udpin:127.0.0.1:0 upd:x:1"}, "unknown kind of link 'upd'"),
        ({"firmware_version": "one"}, "firmware_version is 'one'"),
        ({"uid": "0x12"}, "uid is '0x12'"),
        ({"uid": str(2**64)}, "whole number from 0 to 2"),
        ({"date": "5.2.2026"}, "date is '5.2.2026'"),
        ({"system_id": 1.5}, "system_id is 1.5"),
        ({"system_id": 256.0}, "system_id is 256.0"),
        ({"names": "a b c d e f g h i"}, "names has 9 names, at most 8"),
        ({"names": "far_too_long_name"}, "'far_too_long_name' is not a name"),
        ({"failsafe": "surface"}, "unknown failsafe of this vehicle 'surface'"),
        ({"failsafe": "panic"}, "unknown value of failsafe 'panic'"),
        ({"vehicle_type": "submarin"}, "did you mean 'submarine'"),
        ({"autopilot_type": "generic"}, "known: ardupilotmega, px4"),
        ({"signing_key_file": "key"}, "signing_key_file needs state_file"),
        ({"signing_key_file": "/no/such", "state_file": "/no/state"}, "signing key file /no/such"),
    ],
)
def test_what_cannot_be_is_refused_at_the_start(values, expected):
    component = made(**values)
    with pytest.raises(InputError) as caught:
        component.initialise()
    assert expected in str(caught.value)
    assert component.urls == []  # and nothing stays open


def test_the_profile_says_who_it_is(started, connect):
    parameters = load_profile("hydrone").parameters("links.ground")
    boat = started(**{**parameters, "links": "udpin:127.0.0.1:0"})
    station = connect(boat.urls[0])
    heartbeat = received(boat, station, "HEARTBEAT")
    assert (heartbeat.get_srcSystem(), heartbeat.type, heartbeat.autopilot) == (1, 11, 3)
    home = received(boat, station, "HOME_POSITION")
    assert (home.latitude, home.longitude) == (-317800000, -522600000)


def test_a_peer_is_held_the_last_heartbeat_before_anything_is_sent_to_it(
    started, connect, monkeypatch
):
    order = []
    keep, transmit = EndpointTransport.keep_last, EndpointTransport._transmit

    def kept(self, message):
        keep(self, message)
        order.append(("kept", set(self._links)))

    def sent(self, link, message):
        order.append(("sent", {link.channel}))
        transmit(self, link, message)

    monkeypatch.setattr(EndpointTransport, "keep_last", kept)
    monkeypatch.setattr(EndpointTransport, "_transmit", sent)
    component = started(links="tcpin:127.0.0.1:0")
    connect(component.urls[0])
    until(component, lambda: any(what == "sent" for what, _ in order))
    first = [what for what, _ in order].index("sent")
    (channel,) = order[first][1]
    assert any(what == "kept" and channel in to for what, to in order[:first])
