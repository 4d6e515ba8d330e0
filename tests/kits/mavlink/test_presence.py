import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from .bench import STATION, Bench

CAPABILITIES = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION


def heartbeats(bench):
    return bench.transport.take("HEARTBEAT")


def test_a_heartbeat_a_second_on_every_link():
    bench = Bench()
    bench.wait(10.0)
    for link in (0, 1):
        assert len(bench.transport.take("HEARTBEAT", link)) == 10


@pytest.mark.parametrize(
    ("submerged", "autopilot", "shown"),
    [
        (False, "ardupilotmega", "HOLD"),
        (True, "ardupilotmega", "POSHOLD"),
        (False, "px4", "LOITER"),
    ],
)
def test_ground_stations_read_the_mode_from_it(submerged, autopilot, shown):
    bench = Bench(submerged=submerged, autopilot=autopilot)
    bench.tick()
    heartbeat = heartbeats(bench)[0]
    assert mavutil.mode_string_v10(heartbeat) == shown
    assert heartbeat.type == (12 if submerged else 11)
    assert heartbeat.autopilot == (12 if autopilot == "px4" else 3)


def test_it_sends_at_once_what_changes():
    bench = Bench()
    bench.wait(0.5)
    heartbeats(bench)
    bench.arm()
    bench.tick()
    (armed,) = heartbeats(bench)
    assert armed.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    assert armed.system_status == mavlink.MAV_STATE_ACTIVE
    bench.enter("manual")
    bench.tick()
    (manual,) = heartbeats(bench)
    assert mavutil.mode_string_v10(manual) == "MANUAL"
    assert manual.base_mode & mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0)
    bench.tick()
    (disarmed,) = heartbeats(bench)
    assert not disarmed.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    assert disarmed.system_status == mavlink.MAV_STATE_STANDBY


@pytest.mark.parametrize(
    "ask",
    [
        lambda bench: bench.command(mavlink.MAV_CMD_REQUEST_MESSAGE, CAPABILITIES),
        lambda bench: bench.command(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1),
    ],
)
def test_version_is_sent_on_request_to_the_requester(ask):
    bench = Bench()
    assert ask(bench) == mavlink.MAV_RESULT_ACCEPTED
    (version,) = bench.transport.take("AUTOPILOT_VERSION", STATION.link)
    # Of an ArduPilot of a released version (255), a byte each; its own is 4.5.1-beta.
    assert version.flight_sw_version == 0x040600FF
    assert bytes(version.flight_custom_version) == b"4.5.1bet"
    assert version.uid == 12345
    wanted = (
        mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
        | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    )
    assert version.capabilities & wanted == wanted


def test_pages_of_stations_for_new_submarines_are_not_hidden():
    version = Bench(submerged=True).one(CAPABILITIES)
    # QGroundControl shows motors and frame from Sub 3.5.3 on.
    assert version.flight_sw_version >> 8 >= 0x030503


def test_a_px4_has_its_own_version_as_three_numbers():
    version = Bench(autopilot="px4").one(CAPABILITIES)
    assert version.flight_sw_version == 0x010F00FF
    assert version.flight_custom_version[:3] == [1, 5, 4]


@pytest.mark.parametrize("length", [1, 49, 50, 51, 99, 100, 101, 230])
def test_sentences_of_any_length_arrive(length):
    sentence = "".join(chr(33 + k % 90) for k in range(length))
    bench = Bench()
    bench.vehicle.report(4, sentence)
    bench.tick()
    sender, reader = mavlink.MAVLink(None, 7, 1), mavlink.MAVLink(None)
    pieces = [reader.parse_buffer(m.pack(sender))[0] for m in bench.transport.take("STATUSTEXT")]
    assert "".join(piece.text for piece in pieces) == sentence
    assert {piece.severity for piece in pieces} == {4}
    if length <= 50:
        assert [(p.id, p.chunk_seq) for p in pieces] == [(0, 0)]
    else:
        assert [p.chunk_seq for p in pieces] == list(range(len(pieces)))
        assert len({p.id for p in pieces}) == 1
        assert pieces[0].id > 0
        assert len(pieces[-1].text) < 50  # how a reader knows the last one
    bench.tick()
    assert bench.transport.take("STATUSTEXT") == []
