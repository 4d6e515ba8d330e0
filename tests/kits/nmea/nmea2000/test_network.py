"""Nodes on the simulated bus: addresses, requests, intervals, loss, and rolling back."""

import copy
from itertools import pairwise

import pytest

from seatrial.errors import InputError
from seatrial.system.profile.profile import check_profile, load_profile
from seatrial_kits.can.frame import Frame
from seatrial_kits.nmea.nmea2000.address_claim import name_of
from seatrial_kits.nmea.nmea2000.catalogue import ALL, DATA, NETWORK
from seatrial_kits.nmea.nmea2000.codec import GLOBAL, Encoder, Message

from .network import Network, node

COMPASS = {"sends": "127250", "heading": 1.0, "device_function": 140.0, "device_class": 60.0}
REQUESTER = 200


def request(network, pgn, to):
    network.send_message(Message(59904, {"pgn": pgn}, source=REQUESTER, destination=to))


def after(network, seconds):
    """Run on; return the messages since."""
    before = len(network.messages)
    network.run(seconds)
    return [message for _, message in network.messages[before:]]


@pytest.fixture(scope="module")
def settled():
    """A compass and a pilot that wanted one address, settled."""
    made = Network({"compass": COMPASS, "pilot": {"sends": "127245", "rudder_order": 0.1}})
    made.run(1.0)
    return made


def test_the_lower_name_has_the_address_and_nobody_sends_without_one(settled):
    names = {m.source: name_of(m.fields) for m in settled.sent(60928)}
    compass, pilot = (settled.nodes[n].get("claimed_address") for n in ("compass", "pilot"))
    assert {compass, pilot} == {35, 36}
    assert names[35] < names[36]
    for address in (35, 36):
        claimed = [t for t, m in settled.messages if m.pgn == 60928 and m.source == address]
        data = [t for t, m in settled.messages if m.pgn in DATA and m.source == address]
        assert min(data) > max(claimed) + 249_000_000


def test_a_frame_of_the_bus_has_priority_pgn_and_source(settled):
    """J1939-21: priority << 26 | PGN << 8 | source; destination in the PGN's low byte."""
    compass = settled.nodes["compass"].get("claimed_address")
    identifiers = {frame.identifier for _, frame in settled.frames}
    assert 2 << 26 | 127250 << 8 | compass in identifiers
    assert 6 << 26 | 60928 << 8 | GLOBAL << 8 | compass in identifiers


def test_the_interval_is_exact_and_the_sid_counts(settled):
    found = [(t, m) for t, m in settled.messages if m.pgn == 127250]
    times = [t for t, _ in found]
    assert all(99e6 < b - a < 101e6 for a, b in pairwise(times))
    sids = [m.fields["sid"] for _, m in found]
    assert sids == list(range(len(sids)))


def test_requests_are_answered(settled):
    compass = settled.nodes["compass"].get("claimed_address")
    for pgn in (126996, 126998, 126464, 126993, 60928):
        request(settled, pgn, compass)
    found = after(settled, 0.3)
    sent = {m.pgn: m for m in found if m.source == compass}
    assert sent[126996].fields["modelId"] == "seatrial"
    assert sent[126996].fields["productCode"] == 1
    assert sent[126998].fields["manufacturerInformation"] == "simulated"
    assert sent[126993].fields["dataTransmitOffset"] == 60.0
    assert sent[60928].fields["deviceFunction"] == 140
    lists = {
        m.fields["functionCode"]: {i["pgn"] for i in m.items} for m in found if m.pgn == 126464
    }
    assert lists[0] == {127250, *NETWORK}
    assert {127245, 127237, 59904} <= lists[1]
    assert all(m.destination == REQUESTER for m in found if m.pgn == 126464)


def test_a_request_for_claims_to_all_is_answered_by_all(settled):
    request(settled, 60928, GLOBAL)
    claims = [m.source for m in after(settled, 0.2) if m.pgn == 60928]
    assert sorted(claims) == [35, 36]


def test_what_it_does_not_have_is_refused_unless_the_request_was_to_all(settled):
    compass = settled.nodes["compass"].get("claimed_address")
    request(settled, 130306, compass)
    (refusal,) = [m for m in after(settled, 0.2) if m.pgn == 59392]
    assert (refusal.source, refusal.fields["control"], refusal.fields["pgn"]) == (
        compass,
        1,
        130306,
    )
    request(settled, 130306, GLOBAL)
    assert not [m for m in after(settled, 0.2) if m.pgn == 59392]


def test_data_can_be_requested(settled):
    network = Network({"compass": {**COMPASS, "intervals": "127250 0"}})
    network.run(1.0)
    assert not network.sent(127250)
    request(network, 127250, GLOBAL)
    network.run(0.1)
    (found,) = network.sent(127250)
    assert found.fields["heading"] == pytest.approx(1.0, abs=5e-5)


def request_interval(network, to, pgn, seconds):
    fields = {"functionCode": 0, "pgn": pgn, "transmissionInterval": seconds}
    fields |= {"numberOfParameters": 0}
    message = Message(126208, fields, REQUESTER, to, id="nmeaRequestGroupFunction")
    network.send_message(message)


@pytest.mark.parametrize(
    ("pgn", "seconds", "errors", "count"),
    [
        (127250, 0.5, (0, 0), 4),
        (127250, 0.0, (0, 0), 1),
        (127250, 0.001, (0, 2), 20),
        (130306, 0.5, (2, 0), 20),
        (126720, 0.5, (1, 0), 20),
        (127250, None, (0, 0), 21),
    ],
)
def test_intervals_are_changed_over_the_bus(pgn, seconds, errors, count):
    """Acknowledged as canboat's lookups have it: 1 not supported, 2 not available, 2 too low."""
    network = Network({"compass": COMPASS})
    network.run(1.0)
    request_interval(network, 35, pgn, seconds)
    found = after(network, 2.02)
    (answer,) = [m for m in found if m.pgn == 126208 and m.source == 35]
    assert answer.id == "nmeaAcknowledgeGroupFunction"
    assert answer.destination == REQUESTER
    names = ("pgnErrorCode", "transmissionIntervalPriorityErrorCode")
    assert tuple(answer.fields[name] for name in names) == errors
    assert abs(len([m for m in found if m.pgn == 127250]) - count) <= 1


PILOT = {"sends": "127237 127245", "address": 35.0, "steering_mode": 4}
MODE, REFERENCE, HEADING = 5, 7, 11
"""Numbers of fields of 127237: from 1, reserved ones included."""


def command(network, pgn, *items, source=REQUESTER, to=35):
    """Command fields, (number, value) each; return the PGN's error code and the fields'."""
    fields = {"functionCode": 1, "pgn": pgn, "priority": 8, "numberOfParameters": len(items)}
    listed = tuple({"parameter": number, "value": value} for number, value in items)
    message = Message(126208, fields, source, to, listed, id="nmeaCommandGroupFunction")
    network.send_message(message)
    found = [m for m in after(network, 0.1) if m.pgn == 126208 and m.source == to]
    return [(m.fields["pgnErrorCode"], [each["parameter"] for each in m.items]) for m in found]


def test_fields_are_commanded_over_the_bus():
    network = Network({"pilot": PILOT})
    network.run(1.0)
    assert command(network, 127237, (MODE, 4), (HEADING, 1.25)) == [(0, [0, 0])]
    pilot = network.nodes["pilot"]
    assert pilot.get("bus_heading_to_steer") == pytest.approx(1.25, abs=5e-5)
    assert pilot.get("bus_steering_mode") == 4
    network.run(5.0)
    assert pilot.get("bus_heading_to_steer_valid")  # it stands
    assert command(network, 127237, (HEADING, 0.5), to=GLOBAL) == []
    assert pilot.get("bus_heading_to_steer") == pytest.approx(0.5, abs=5e-5)


@pytest.mark.parametrize(
    ("pgn", "items", "answer"),
    [
        (127237, [(MODE, 7), (HEADING, 1.25)], (0, [3, 0])),  # canboat: 3 out of range
        (127237, [(REFERENCE, 1), (HEADING, 1.25)], (0, [3, 3])),  # magnetic
        (127237, [(REFERENCE, 0), (HEADING, 1.25)], (0, [0, 0])),
        (127237, [(99, 1)], (0, [1])),  # invalid
        (127237, [(18, 1.0)], (0, [5])),  # not supported
        (127245, [(1, 0), (4, 0.1)], (0, [0, 0])),
        (127245, [(1, 1), (4, 0.1)], (0, [3, 3])),  # another rudder
        (127245, [(5, 0.1)], (0, [5])),  # a measurement
        (127250, [(2, 0.1)], (1, [])),  # 1: PGN not supported
    ],
)
def test_only_what_is_obeyed_is_acknowledged(pgn, items, answer):
    network = Network({"pilot": PILOT})
    network.run(1.0)
    assert command(network, pgn, *items) == [answer]
    obeyed = (HEADING, 1.25) in items and answer[1][-1:] == [0]
    assert network.nodes["pilot"].get("bus_heading_to_steer_valid") == obeyed


def test_a_node_is_commanded_in_what_it_sends_alone():
    network = Network({"compass": {**COMPASS, "address": 35.0}})
    network.run(1.0)
    assert command(network, 127237, (HEADING, 1.25)) == [(2, [])]  # not available
    assert not network.nodes["compass"].get("bus_heading_to_steer_valid")


def test_a_rudder_is_commanded_unless_another_node_orders_it():
    gear = {"sends": "127245", "address": 35.0, "device_function": 155.0}
    pilot = {"sends": "127245", "address": 36.0, "rudder_order": -0.2, "silent": True}
    network = Network({"gear": gear, "pilot": pilot})
    network.run(1.0)
    assert command(network, 127245, (4, 0.1)) == [(0, [0])]
    assert network.nodes["gear"].get("bus_rudder_order") == pytest.approx(0.1, abs=5e-5)
    network.nodes["pilot"].set("silent", False)
    network.run(2.0)  # the command is out of date
    assert network.nodes["gear"].get("bus_rudder_order") == pytest.approx(-0.2, abs=5e-5)
    assert command(network, 127245, (4, 0.1)) == [(0, [4])]  # canboat: access denied
    assert network.nodes["gear"].get("bus_rudder_order") == pytest.approx(-0.2, abs=5e-5)


def helm(network):
    return round(network.nodes["pilot"].get("bus_heading_to_steer"), 3)


def test_the_newest_order_has_the_helm():
    """A command, a first order, another order than before; what is repeated takes nothing."""
    plotter = {"sends": "127237", "address": 36.0, "heading_to_steer": 0.1}
    network = Network({"pilot": PILOT, "plotter": plotter})
    network.run(1.0)
    assert helm(network) == 0.1
    assert command(network, 127237, (HEADING, 1.25)) == [(0, [0])]
    network.run(3.0)
    assert helm(network) == 1.25  # the plotter repeats 0.1
    network.nodes["plotter"].set("heading_to_steer", 0.2)
    network.run(0.5)
    assert helm(network) == 0.2
    # An outside plotter that sends 127237 itself steers too, and gives the helm back.
    for _ in range(8):
        outside = {"headingReference": 0, "headingToSteerCourse": 2.5}
        network.send_message(Message(127237, outside, REQUESTER))
        network.run(0.25)
        assert helm(network) == 2.5
    network.run(1.5)
    assert helm(network) == 0.2
    assert network.nodes["pilot"].get("bus_heading_to_steer_valid")
    command(network, 127237, (HEADING, 1.25))
    network.nodes["plotter"].set("heading_to_steer", 1e30)  # none
    network.run(0.5)
    assert helm(network) == 1.25


def test_a_command_leaves_other_orders_of_the_commander_valid():
    network = Network({"pilot": PILOT})
    network.run(1.0)
    outside = {"headingReference": 0, "headingToSteerCourse": 2.5, "track": 0.75}
    network.send_message(Message(127237, outside, REQUESTER))
    network.run(0.1)
    assert command(network, 127237, (HEADING, 1.25)) == [(0, [0])]
    assert network.nodes["pilot"].get("bus_track_valid")
    network.send_message(Message(127237, outside, REQUESTER))
    network.run(0.1)
    assert helm(network) == 1.25  # what it goes on to send is no new order


def test_the_heartbeat_comes_every_minute():
    network = Network({"node": {}}, step_ns=1_000_000_000)
    network.run(130.0)
    beats = [(t, m.fields["sequenceCounter"]) for t, m in network.messages if m.pgn == 126993]
    assert [count for _, count in beats] == [0, 1, 2]
    assert beats[2][0] - beats[1][0] == pytest.approx(60e9, abs=1e6)


@pytest.mark.parametrize("count", [2, 4])
def test_nodes_switched_on_together_settle_on_the_bus(count):
    """They all want 35, and differ in one instance: the bus's own collisions included."""
    network = Network({f"n{k}": {"device_instance": float(k)} for k in range(count)})
    network.run(2.0)
    addresses = [n.get("claimed_address") for n in network.nodes.values()]
    assert addresses[0] == 35  # the lowest NAME
    assert sorted(addresses) == list(range(35, 35 + count))


def test_a_claim_in_the_middle_of_a_fast_packet_ends_it():
    """The rest would otherwise go on with another node's frames of the same address."""
    network = Network({"reader": {"address": 90.0}})
    network.run(1.0)

    def gnss(latitude):
        fields = {"sid": 1, "latitude": latitude, "longitude": 5.0, "altitude": 0.0, "method": 1}
        return Encoder({}).encode(Message(129029, fields, source=35))

    one, other = gnss(10.0), gnss(20.0)
    claim = {"uniqueNumber": 1, "manufacturerCode": 1, "deviceFunction": 1, "deviceClass": 1}
    for frames in (one[:3], Encoder({}).encode(Message(60928, claim, 35)), other[3:]):
        for frame in frames:
            network.send(frame)
        network.run(0.03)  # a claim has a low priority
    reader = network.nodes["reader"]
    assert not reader.get("bus_position_valid")
    # Without the claim, no node could know.
    for frame in (*one[:3], *other[3:]):
        network.send(frame)
    network.run(0.2)
    assert reader.get("bus_position_valid")


def test_a_node_that_loses_its_address_in_a_fast_packet_goes_on_from_another():
    network = Network({"gnss": {"sends": "129029", "position_n": [0.0, 0.0, 0.0]}})
    network.run(1.005)  # the packet of t = 1 s is being sent
    lower = dict.fromkeys(network.nodes["gnss"]._identity.claim(), 0)
    network.send_message(Message(60928, lower, source=35))
    network.run(2.0)
    gnss = network.nodes["gnss"]
    assert gnss.get("claimed_address") == 36
    assert gnss.get("contests") == 1
    assert {m.source for m in network.sent(129029)} <= {35, 36}
    assert network.sent(129029, 36)
    silent = [t for t, m in network.messages if m.source in (35, 36) and m.pgn in DATA]
    moved = max(t for t, m in network.messages if m.pgn == 60928 and m.source == 36)
    assert not [t for t in silent if moved < t < moved + 250_000_000]


@pytest.mark.slow
def test_five_percent_of_loss_gives_no_wrong_value():
    settings = {
        "sends": "127250 129029 127237 126992",
        "intervals": "129029 0.1; 127237 0.1; 126992 0.1",
        "position_n": [0.0, 0.0, 0.0],
        "latitude": 0.5,
        "longitude": -0.7,
        "heading": 1.2345,
        "heading_to_steer": 2.5,
    }
    network = Network({"all": settings, "reader": {"address": 90.0}}, {"loss": 0.05})
    network.run(15.0)
    counts = {}
    for pgn in (127250, 129029, 127237):
        found = network.sent(pgn)
        counts[pgn] = len(found) / 147
        for each in found:
            known = {
                127250: ("heading", 1.2345),
                129029: ("latitude", 28.64788975654116),
                127237: ("headingToSteerCourse", 2.5),
            }[pgn]
            assert each.fields[known[0]] == pytest.approx(known[1], abs=1e-9)
    assert counts[127250] == pytest.approx(0.95, abs=0.06)
    assert counts[129029] == pytest.approx(0.95**7, abs=0.13)
    assert counts[127237] == pytest.approx(0.95**4, abs=0.11)


def test_a_copy_of_the_state_goes_on_to_the_same_bytes():
    """Also in the middle of a fast packet, for reader and sender."""
    gnss = {"sends": "129029 127250 129025", "position_n": [1.0, 2.0, 3.0]}
    network = Network({"gnss": gnss, "reader": {}}, step_ns=1_000_000)
    network.run(1.0)
    reader, sender = network.nodes["reader"], network.nodes["gnss"]
    while not reader.get_state()["_unfinished"]:
        network.run(0.001)
    twins = node("reader"), node("gnss", **gnss)
    for twin, original in zip(twins, (reader, sender), strict=True):
        twin.set_state(copy.deepcopy(original.get_state()))
    for _ in range(300):
        t = network.now / 1e9
        network.run(0.001)
        for twin, original in zip(twins, (reader, sender), strict=True):
            twin.set("rx", original.get("rx"))
            twin.advance(t, 0.001)
            assert twin.get_state() == original.get_state()
    assert reader.get("bus_position_n") == pytest.approx([1.0, 2.0, 3.0], abs=0.02)


def test_names_of_the_standard_give_the_number():
    """The NAME of canboat's own function."""
    from nmea2000._canboat import iso_name

    made = node(uid=str(2**40 + 12345), manufacturer_code=229.0, device_function=145.0)
    claim = made._identity.claim()
    assert name_of(claim) == iso_name(
        229,
        (2**40 + 12345) % 2**21,
        device_function=145,
        device_class=25,
        device_instance=0,
        system_instance=0,
        industry_group=4,
        arbitrary_address_capable=True,
    )


def test_intervals_are_those_of_canboats_table():
    from nmea2000.backend import DATABASE

    for pgn in DATA.values():
        (known,) = DATABASE.pgn_variants(pgn.number)
        assert known.id == pgn.id
        if known.transmission_interval is None:  # AIS when it is received; of routes it has none
            assert pgn.interval_s == (5.0 if pgn.number == 129285 else 0.0)
        else:
            assert known.transmission_interval == round(pgn.interval_s * 1000)
        assert {field.name for field in pgn.fields} <= {field.id for field in known.fields}
    assert ALL[126993].interval_s == 60.0


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"sends": "127250 127252"}, "unknown PGN '127252'; did you mean"),
        ({"sends": "127250 127250"}, "127250 is there twice"),
        ({"intervals": "127250 fast"}, "is not PGN SECONDS"),
        ({"intervals": "127250 0.001"}, "allowed 0.01 to 3600 s"),
        ({"uid": "abc"}, "uid is 'abc', a whole number"),
        ({"date": "yesterday"}, "a day like '2026-02-05' is needed"),
        ({"device_function": 1.5}, "device_function is 1.5, a whole number is needed"),
    ],
)
def test_mistakes_are_named(settings, message):
    with pytest.raises(InputError, match=message):
        node(**settings)


def test_frames_of_others_do_no_harm():
    network = Network({"node": {}})
    network.run(0.5)
    for frame in (
        Frame(0x123, b"12"),
        Frame(0x1FFFFFFF, bytes(8), True),
        Frame(0x09F80500, b"", True),
    ):
        network.send(frame)
    network.send(Frame(0x09F80523, b"\x40", True))
    network.run(0.1)
    assert network.nodes["node"].get("claimed_address") == 35


PROFILE = """
title = "A boat with an NMEA 2000 sounder"
[identity]
system_id = 1
component_id = 1
vehicle_type = "surface_boat"
autopilot_type = "ardupilotmega"
firmware_version = "0.1.0-dev"
uid = 4242
[home]
latitude = "10 deg"
longitude = "20 deg"
altitude = "0 m"
date = 2026-01-01
source = "invented"
[links.sounder]
kind = "nmea2000-node"
sends = "{sends}"
address = 40
"""


def test_a_profile_gives_a_node_its_serial_number_origin_and_date(tmp_path):
    path = tmp_path / "boat.toml"
    path.write_text(PROFILE.format(sends="128267"), "utf-8")
    values = load_profile(path).parameters("links.sounder")
    assert values["uid"] == "4242"
    assert (values["date"], values["address"]) == ("2026-01-01", 40.0)
    assert values["latitude"] == pytest.approx(0.174533, abs=1e-6)


def test_a_profile_with_an_unknown_pgn_is_refused_with_near_misses(tmp_path):
    path = tmp_path / "boat.toml"
    path.write_text(PROFILE.format(sends="128276"), "utf-8")
    with pytest.raises(InputError, match=r"links\.sounder\.sends.*'128276'; did you mean '128267'"):
        check_profile(path)
