"""NMEA 2000 nodes, with canboat's two implementations as reference tools: in JavaScript, and in Rust.

The second is the Python package's, on which the nodes are built; the first is somebody else's.
"""

import csv
import math
import random
from dataclasses import replace

import can
import pytest
from nmea2000 import NMEA2000Decoder

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.can.messages import frame_of
from seatrial_kits.nmea.nmea2000.codec import Decoder, Message
from seatrial_kits.nmea.nmea2000.quantities import READERS
from seatrial_kits.nmea.nmea2000.traffic import report
from tests.interop import canboat
from tests.kits.nmea.nmea2000.network import Network
from tests.kits.nmea.nmea2000.test_fields_absent import any_value, fields_of

pytestmark = canboat.needed

EVERYTHING = (
    "126992 127237 127245 127250 127251 127257 127258 127488 127489 128259 128267 129025 129026 "
    "129029 130306"
)
FAST = "; ".join(f"{pgn} 0.1" for pgn in EVERYTHING.split())


def value(message, field):
    """Return a field of canboat's, None if it is not available: it may leave those out."""
    return message["fields"].get(field)


def wrapped(a, b):
    """Return the difference of two angles, without turns."""
    return abs(math.remainder(a - b, math.tau))


def plant(rng):
    """Random values for all that a node measures: inputs by name."""
    angle = lambda: rng.uniform(-math.pi, math.pi)  # noqa: E731
    return {
        "heading": rng.uniform(-10, 10),
        "deviation": rng.uniform(-0.2, 0.2),
        "variation": rng.uniform(-0.5, 0.5),
        "rate_of_turn": rng.uniform(-1, 1),
        "attitude": [rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-10, 10)],
        "rudder": rng.uniform(-0.7, 0.7),
        "rudder_order": rng.uniform(-0.7, 0.7),
        "water_speed": rng.uniform(0, 20),
        "depth": rng.uniform(0, 11000),
        "position_n": [rng.uniform(-5000, 5000), rng.uniform(-5000, 5000), rng.uniform(-50, 50)],
        "velocity_n": [rng.uniform(-10, 10), rng.uniform(-10, 10), 0.0],
        "wind_speed": rng.uniform(0, 50),
        "wind_angle": angle(),
        "true_wind": [rng.uniform(-20, 20), rng.uniform(-20, 20)],
        "engine_speed": [rng.uniform(-300, 300), rng.uniform(0, 300), 1e30, 1e30],
        "engine_voltage": [rng.uniform(0, 60), 1e30, 1e30, 1e30],
        "engine_temperature": [rng.uniform(250, 400), 1e30, 1e30, 1e30],
        "engine_load": [rng.uniform(-1, 1), 1e30, 1e30, 1e30],
        "steering_mode": rng.randrange(6),
        "heading_to_steer": rng.uniform(-10, 10),
        "track": rng.uniform(-10, 10),
        "commanded_rudder": rng.uniform(-0.7, 0.7),
        "rudder_limit": rng.uniform(0, 0.7),
    }


def run(network, rng, rounds):
    """Change everything at random between two messages; return [(from ns, inputs)]."""
    node, history = network.nodes["node"], []
    for _ in range(rounds):
        values = plant(rng)
        for name, each in values.items():
            node.set(name, each)
        history.append((network.now, values))
        network.run(0.1)
    network.run(0.05)
    return history


def read(network, history):
    """Return {PGN: [(canboat's message, the inputs when its last frame was sent)]}."""
    found = {}
    for message in canboat.decoded(network.frames):
        assert "error" not in message
        when, _ = network.frames[message["line"]]
        inputs = next(values for start, values in reversed(history) if start <= when)
        found.setdefault(message["pgn"], []).append((message, inputs))
    return found


HALF = 0.5 + 1e-6
"""Half a resolution, and rounding of doubles."""


def check(found):
    """All fields of all messages, within half their resolutions (canboat.json)."""
    for message, v in found[127250]:
        assert wrapped(value(message, "heading"), v["heading"]) <= HALF * 1e-4
        assert value(message, "deviation") == pytest.approx(v["deviation"], abs=HALF * 1e-4)
        assert value(message, "variation") == pytest.approx(v["variation"], abs=HALF * 1e-4)
        assert value(message, "reference") == "True"
    for message, v in found[127251]:
        assert value(message, "rate") == pytest.approx(
            v["rate_of_turn"], abs=HALF * 3.125e-8 + 1e-8
        )
    for message, v in found[127257]:
        for field, angle in zip(("roll", "pitch", "yaw"), v["attitude"], strict=True):
            assert wrapped(value(message, field), angle) <= HALF * 1e-4
    for message, v in found[127245]:
        assert value(message, "position") == pytest.approx(v["rudder"], abs=HALF * 1e-4)
        assert value(message, "angleOrder") == pytest.approx(v["rudder_order"], abs=HALF * 1e-4)
        way = "Move to starboard" if v["rudder_order"] > 0 else "Move to port"
        assert value(message, "directionOrder") == way
    for message, v in found[128259]:
        speed = math.hypot(*v["velocity_n"])
        assert value(message, "speedWaterReferenced") == pytest.approx(
            v["water_speed"], abs=0.00501
        )
        assert value(message, "speedGroundReferenced") == pytest.approx(speed, abs=0.00501)
    for message, v in found[128267]:
        assert value(message, "depth") == pytest.approx(v["depth"], abs=0.00501)
        assert value(message, "offset") == pytest.approx(0.5)
    for message, v in found[129026]:
        north, east, _ = v["velocity_n"]
        assert wrapped(value(message, "cog"), math.atan2(east, north)) <= HALF * 1e-4
        assert value(message, "sog") == pytest.approx(math.hypot(north, east), abs=0.00501)
        assert value(message, "cogReference") == "True"
    for message, v in found[127258]:
        assert value(message, "source") == "Manual"
        assert value(message, "ageOfService") == "2026.02.05"
        assert value(message, "variation") == pytest.approx(v["variation"], abs=0.51e-4)
    for message, v in found[130306]:
        if value(message, "reference") == "Apparent":
            speed, comes_from = v["wind_speed"], v["wind_angle"] + math.pi
        else:
            north, east = v["true_wind"]
            speed, comes_from = math.hypot(north, east), math.atan2(-east, -north)
        assert value(message, "windSpeed") == pytest.approx(speed, abs=0.00501)
        assert wrapped(value(message, "windAngle"), comes_from) <= HALF * 1e-4
    check_position(found)
    check_engines(found)
    check_commands(found)


def check_position(found):
    """Metres per degree on the ellipsoid of WGS 84, near the origin: within 5 km to 1e-3."""
    for pgn, resolution in ((129025, 0.006), (129029, 1e-6)):
        for message, v in found[pgn]:
            north, east, down = v["position_n"]
            latitude = math.radians(value(message, "latitude"))
            e2, a = 6.69437999014e-3, 6378137.0
            w = math.sqrt(1 - e2 * math.sin(latitude) ** 2)
            d_north = (latitude - ORIGIN[0]) * a * (1 - e2) / w**3
            d_east = (math.radians(value(message, "longitude")) - ORIGIN[1]) * a / w
            d_east *= math.cos(latitude)
            assert d_north == pytest.approx(north, abs=8.0 + resolution)
            assert d_east == pytest.approx(east, abs=8.0 + resolution)
            if pgn == 129029:
                assert value(message, "altitude") == pytest.approx(12.0 - down, abs=1e-5)
                assert value(message, "date") == "2026.02.05"
                assert value(message, "method") == "GNSS fix"


def check_engines(found):
    for message, v in found[127488]:
        number = 0 if value(message, "instance").startswith("Single") else 1
        rpm = abs(v["engine_speed"][number]) * 60 / math.tau
        assert value(message, "speed") == pytest.approx(rpm, abs=0.126 + 0.05)  # printed to 0.1
    for message, v in found[127489]:
        assert value(message, "alternatorPotential") == pytest.approx(
            v["engine_voltage"][0], abs=0.00501
        )
        temperature = v["engine_temperature"][0]
        assert value(message, "temperature") == pytest.approx(temperature, abs=0.00501)
        assert value(message, "engineLoad") == pytest.approx(
            100 * abs(v["engine_load"][0]), abs=0.51
        )
        assert value(message, "discreteStatus1") in ([], "", None)


def check_commands(found):
    modes = ("Main Steering", "Non-Follow-Up Device", "Follow-Up Device")
    modes += ("Heading Control Standalone", "Heading Control", "Track Control")
    for message, v in found[127237]:
        assert value(message, "steeringMode") == modes[v["steering_mode"]]
        assert value(message, "headingReference") == "True"
        for field, port in (
            *(("headingToSteerCourse", "heading_to_steer"), ("track", "track")),
            *(("commandedRudderAngle", "commanded_rudder"), ("vesselHeading", "heading")),
            ("rudderLimit", "rudder_limit"),
        ):
            assert wrapped(value(message, field), v[port]) <= HALF * 1e-4


ORIGIN = (math.radians(-31.78), math.radians(-52.26))
NODE = {
    "sends": EVERYTHING,
    "intervals": FAST,
    "transducer_offset": 0.5,
    "date": "2026-02-05",
    "latitude": ORIGIN[0],
    "longitude": ORIGIN[1],
    "altitude": 12.0,
    "uid": "12345",
}


def test_canboat_reads_every_field_of_what_a_node_sends():
    network = Network({"node": NODE})
    network.run(0.5)
    network.frames.clear()
    history = run(network, random.Random(1), 60)
    found = read(network, history)
    assert set(found) >= {int(pgn) for pgn in EVERYTHING.split()}
    assert all(len(each) >= 55 for pgn, each in found.items() if pgn in (127250, 129029, 127237))
    check(found)


def test_canboat_reads_the_log_of_a_run(tmp_path):
    network = Network({"node": NODE}, {"run_folder": str(tmp_path)})
    network.run(1.0)
    network.bus.close()
    lines = (tmp_path / "bus.log").read_text().splitlines()
    assert len(lines) > 100
    found, same = canboat.read(lines), canboat.decoded(network.frames)
    assert [m["fields"] for m in found[: len(same)]] == [m["fields"] for m in same]
    assert {m["pgn"] for m in same} >= {126992, 127237, 127250, 129025, 129029}


def test_loss_gives_canboat_no_wrong_value():
    network = Network({"node": NODE}, {"loss": 0.05})
    network.run(0.5)
    while network.nodes["node"].get("claimed_address") == 254:
        network.run(0.1)
    network.frames.clear()
    history = run(network, random.Random(2), 60)
    found = read(network, history)
    check(found)
    assert 35 < len(found[129029]) < 59
    assert len(found[127250]) < 60


def test_canboat_reads_what_is_not_available_as_nothing():
    network = Network({"node": {"sends": EVERYTHING, "intervals": FAST}})
    network.run(1.0)
    kept = {"sid", "source", "date", "time", "instance", "gnssType", "method", "integrity"}
    kept |= {
        "numberOfSvs",
        "referenceStations",
        "reference",
        "cogReference",
        "headingReference",
        "offset",
        "list",
    }
    found = [
        m for m in canboat.decoded(network.frames) if m["pgn"] >= 126992 and m["pgn"] != 126993
    ]
    assert {m["pgn"] for m in found} == {int(p) for p in EVERYTHING.split()} - {127488, 127489}
    for message in found:
        rest = {name: v for name, v in message["fields"].items() if name not in kept}
        assert set(rest.values()) <= {None}, message


def test_canboat_knows_the_identity():
    network = Network({"node": {**NODE, "device_function": 145.0, "device_class": 60.0}})
    network.run(0.5)
    for pgn in (60928, 126996, 126998, 126464, 126993):
        network.send_message(Message(59904, {"pgn": pgn}, 200, 35))
    network.send_message(Message(59904, {"pgn": 65240}, 200, 35))
    network.run(0.3)
    found = {m["pgn"]: m for m in canboat.decoded(network.frames) if m["src"] == 35}
    claim = found[60928]["fields"]
    assert (claim["uniqueNumber"], claim["deviceClass"]) == (12345, "Navigation")
    assert claim["deviceFunction"] in (145, "Ownship Position (GNSS)")
    assert claim["arbitraryAddressCapable"] == "Yes"
    assert found[126996]["fields"]["modelId"] == "seatrial"
    assert found[126998]["fields"]["manufacturerInformation"] == "simulated"
    assert found[126993]["fields"]["equipmentStatus"] == "Operational"
    assert len(found[126464]["fields"]["list"]) >= 14
    assert found[59392]["fields"]["control"] == "NAK"
    assert found[59392]["fields"]["pgn"] == 65240


def test_canboats_commands_are_obeyed_or_not_acknowledged():
    """What it encodes takes the helm from another plotter; what is answered, it decodes."""
    plotter = {"sends": "127237", "address": 40.0, "heading_to_steer": 0.1}
    network = Network({"pilot": {"sends": "127237", "address": 35.0}, "plotter": plotter})
    network.run(1.0)
    fields = {"functionCode": "Command", "pgn": 127237, "priority": 8}
    for parameter, value in ((11, 1.25), (18, 0.5)):
        listed = [{"parameter": parameter, "value": value}]
        message = {"pgn": 126208, "src": 200, "dst": 35, "prio": 3}
        message["fields"] = {**fields, "numberOfParameters": 1, "list": listed}
        (frames,) = canboat.encoded([message])
        for frame in frames:
            network.send(frame)
        network.run(0.1)
    network.run(2.0)
    assert network.nodes["pilot"].get("bus_heading_to_steer") == pytest.approx(1.25, abs=5e-5)
    found = [m for m in canboat.decoded(network.frames) if m["pgn"] == 126208 and m["src"] == 35]
    assert [m["fields"]["functionCode"] for m in found] == ["Acknowledge"] * 2
    answers = [m["fields"]["list"][0]["parameter"] for m in found]
    assert answers == ["Acknowledge", "Not supported"]


def test_a_node_reads_every_field_of_what_canboat_sends():
    rng = random.Random(3)
    network = Network({"node": {"latitude": ORIGIN[0], "longitude": ORIGIN[1]}})
    network.run(0.5)
    node = network.nodes["node"]
    rounds = [theirs(rng) for _ in range(25)]
    frames = iter(canboat.encoded([m for messages, _ in rounds for m in messages]))
    for messages, expected in rounds:
        for _ in messages:
            for frame in next(frames):
                network.send(frame)
        network.run(0.1)
        for port, wanted in expected.items():
            got = node.get(port)
            if isinstance(wanted, tuple):
                wanted, tolerance = wanted
                assert math.isclose(math.remainder(got - wanted, math.tau), 0, abs_tol=tolerance), (
                    port
                )
            else:
                assert got == wanted, port


def theirs(rng):
    """Random messages as canboat has them, and what a node is to make of them."""
    heading, variation, rate = rng.uniform(0, 6.28), rng.uniform(-0.5, 0.5), rng.uniform(-1, 1)
    roll, pitch, yaw = (rng.uniform(-1, 1) for _ in range(3))
    order, position, depth = rng.uniform(-0.7, 0.7), rng.uniform(-0.7, 0.7), rng.uniform(0, 500)
    steer, track, speed = rng.uniform(0, 6.28), rng.uniform(0, 6.28), rng.uniform(0, 20)
    wind_speed, wind_angle, rpm = rng.uniform(0, 40), rng.uniform(0, 6.28), rng.uniform(0, 4000)
    sog, cog, magnetic = rng.uniform(0.1, 20), rng.uniform(0, 6.28), rng.random() < 0.5
    mode = rng.choice(("Main Steering", "Heading Control", "Track Control"))
    fields = {
        127250: {"heading": heading, "variation": variation}
        | {"reference": "Magnetic" if magnetic else "True"},
        127251: {"rate": rate},
        127257: {"roll": roll, "pitch": pitch, "yaw": yaw},
        127245: {"instance": 0, "angleOrder": order, "position": position},
        128267: {"depth": depth},
        128259: {"speedWaterReferenced": speed},
        127237: {"steeringMode": mode, "headingToSteerCourse": steer, "track": track}
        | {"commandedRudderAngle": order, "headingReference": "True"},
        130306: {"windSpeed": wind_speed, "windAngle": wind_angle, "reference": "Apparent"},
        127488: {"instance": "Dual Engine Starboard", "speed": rpm},
        129026: {"cogReference": "True", "cog": cog, "sog": sog},
    }
    messages = [{"pgn": p, "src": 9, "dst": 255, "prio": 3, "fields": f} for p, f in fields.items()]
    angle, number = 1e-4, 0.011
    return messages, {
        "bus_heading": (heading + variation * magnetic, 1.01 * angle),
        "bus_rate_of_turn": (rate, 4e-8),
        "bus_attitude.phi": (roll, angle),
        "bus_attitude.theta": (pitch, angle),
        "bus_attitude.psi": (yaw, angle),
        "bus_rudder_order": (order, angle),
        "bus_rudder": (position, angle),
        "bus_commanded_rudder": (order, angle),
        "bus_heading_to_steer": (steer, angle),
        "bus_track": (track, angle),
        "bus_wind_angle": (wind_angle - math.pi, angle),
        "bus_steering_mode": {"M": 0, "H": 4, "T": 5}[mode[0]],
        "bus_heading_valid": True,
        "bus_rudder_order_valid": True,
        "bus_depth": (depth, number),
        "bus_water_speed": (speed, number),
        "bus_wind_speed": (wind_speed, number),
        "bus_engine_speed.e2": (rpm * math.tau / 60, 0.03),
        "bus_velocity_n.north": (sog * math.cos(cog), 0.012),
        "bus_velocity_n.east": (sog * math.sin(cog), 0.012),
    }


def test_both_canboats_read_the_log_of_a_rig_as_its_plant_was(tmp_path):
    trial = load_trial("hydrone-nmea2000-square").changed({"stop": "5 s"}, "test")
    result = run_trial(trial, tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    with (result.folder / "signals.csv").open() as file:
        rows = list(csv.DictReader(file))
    with can.LogReader(str(result.folder / "autopilot.network.can.blf")) as log:
        messages = list(log)
    frames = [(round(m.timestamp * 1e9), frame_of(m)) for m in messages]
    decoder, pythons = NMEA2000Decoder(), []
    for message in messages:
        found = decoder.decode(message)
        if found is not None:
            pythons.append((message.timestamp, found.PGN, {f.id: f.value for f in found.fields}))
    scripts = [(frames[m["line"]][0] / 1e9, m["pgn"], m["fields"]) for m in canboat.decoded(frames)]
    assert [(p, pytest.approx(t)) for t, p, _ in pythons] == [(p, t) for t, p, _ in scripts]
    assert {p for _, p, _ in pythons} >= {127237, 127488, 127489, 128267, 129025, 129029, 127257}
    for found in (pythons, scripts):
        for time, pgn, fields in found:
            hull = rows[min(round(time * 10), len(rows) - 1)]
            as_hull(pgn, fields, {name: float(hull[f"vehicle.hull.{name}"]) for name in HULL})


HULL = ("position.x", "position.y", "attitude.phi", "attitude.psi", "rates.r")


def as_hull(pgn, fields, hull):
    """Within what the instruments' noise, delays and offsets make."""
    if pgn == 127250:
        assert wrapped(fields["heading"], hull["attitude.psi"]) < 0.1
    elif pgn == 127251:
        assert fields["rate"] == pytest.approx(hull["rates.r"], abs=0.1)
    elif pgn == 127257:
        assert fields["roll"] == pytest.approx(hull["attitude.phi"], abs=0.05)
    elif pgn in (129025, 129029) and fields["latitude"] is not None:
        north = (math.radians(fields["latitude"]) - ORIGIN[0]) * 6.353e6
        east = (math.radians(fields["longitude"]) - ORIGIN[1]) * 6.384e6 * math.cos(ORIGIN[0])
        assert north == pytest.approx(hull["position.x"], abs=0.6)
        assert east == pytest.approx(hull["position.y"], abs=0.6)
    elif pgn == 128267:
        assert fields["depth"] == 3.5
    elif pgn == 127489:
        assert fields["alternatorPotential"] == 16.0


FROM_CANBOAT = {
    127245: {"rudder": "position", "rudder_order": "angleOrder"},
    127250: {"heading": "heading", "magnetic_heading": "heading", "variation": "variation"},
    127251: {"rate_of_turn": "rate"},
    127257: {"roll": "roll", "pitch": "pitch", "yaw": "yaw"},
    127258: {"variation": "variation"},
    127488: {"engine_speed 0": "speed"},
    127489: {
        "engine_fuel_rate 0": "fuelRate",
        "engine_temperature 0": "temperature",
        "engine_oil_pressure 0": "oilPressure",
        "engine_voltage 0": "alternatorPotential",
        "engine_load 0": "engineLoad",
    },
    128259: {"water_speed": "speedWaterReferenced", "speed_over_ground": "speedGroundReferenced"},
    128267: {"depth": "depth", "depth_offset": "offset"},
    129025: {"place": ("latitude", "longitude")},
    129026: {"course": "cog", "magnetic_course": "cog", "speed_over_ground": "sog"},
    129029: {"place": ("latitude", "longitude"), "altitude": "altitude"},
    129283: {"cross_track": "xte"},
    129284: {
        "waypoint_distance": "distanceToWaypoint",
        "waypoint_bearing": "bearingPositionToDestinationWaypoint",
        "magnetic_waypoint_bearing": "bearingPositionToDestinationWaypoint",
        "leg_direction": "bearingOriginToDestinationWaypoint",
        "magnetic_leg_direction": "bearingOriginToDestinationWaypoint",
        "waypoint_number": "destinationWaypointNumber",
        "waypoint_place": ("destinationLatitude", "destinationLongitude"),
        "closing_speed": "waypointClosingVelocity",
    },
    130306: {
        "wind_speed": "windSpeed",
        "wind_angle": "windAngle",
        "water_wind_speed": "windSpeed",
        "water_wind_angle": "windAngle",
        "ground_wind_speed": "windSpeed",
        "ground_wind_angle": "windAngle",
        "wind_direction": "windAngle",
        "magnetic_wind_direction": "windAngle",
    },
    130310: {
        "water_temperature": "waterTemperature",
        "air_temperature": "outsideAmbientAirTemperature",
        "air_pressure": "atmosphericPressure",
    },
    130311: {
        "water_temperature": "temperature",
        "air_temperature": "temperature",
        "air_pressure": "atmosphericPressure",
        "humidity": "humidity",
    },
    130312: {"water_temperature": "actualTemperature", "air_temperature": "actualTemperature"},
    130313: {"humidity": "actualHumidity"},
    130314: {"air_pressure": "pressure"},
    130315: {"set_pressure": "pressure"},
    130316: {"water_temperature": "temperature", "air_temperature": "temperature"},
}
"""Fields of canboat's that quantities are, by PGN."""
UNITS = {"engine_speed 0": math.tau / 60.0, "humidity": 0.01}
UNITS |= {"engine_fuel_rate 0": 1e-3 / 3600.0, "engine_load 0": 0.01}
AIS_FIELDS = {"latitude": "latitude", "longitude": "longitude", "course": "cog", "speed": "sog"}
REPORTS = {
    129038: AIS_FIELDS | {"heading": "heading"},
    129039: AIS_FIELDS | {"heading": "heading"},
    129040: AIS_FIELDS | {"heading": "trueHeading", "length": "length", "beam": "beam"},
    129041: {"latitude": "latitude", "longitude": "longitude"}
    | {"length": "lengthDiameter", "beam": "beamDiameter"},
    129809: {},
    129810: {"length": "length", "beam": "beam"},
}


def with_gaps(pgn, rng):
    """Return a message for canboat to encode: any values, any of them left out."""
    values = {f.id: any_value(pgn, f, rng) for f in fields_of(pgn)}
    kept = {k: v for k, v in values.items() if k not in ("communicationState", "atonStatus")}
    kept.pop("navigationTerminated", None)
    present = {k: v for k, v in kept.items() if rng.random() < 0.7}
    present |= {k: 0 for k in ("instance",) if k in values}
    present |= {k: values[k] for k in ("userId", "method") if k in values}
    for name in (
        "date",
        "etaDate",
        "time",
        "etaTime",
        "ageOfService",
        "totalEngineHours",
        "discreteStatus1",
        "discreteStatus2",
    ):  # canboat encodes them as texts
        present.pop(name, None)
    return {"pgn": pgn, "src": 7, "dst": 255, "prio": 3, "fields": present}


@pytest.mark.parametrize("pgn", [*FROM_CANBOAT, *REPORTS])
def test_quantities_are_those_of_canboat_whatever_is_absent(pgn):
    """Frames that canboat writes; what it reads in them, and what a node here does."""
    rng = random.Random(pgn)
    packets = canboat.encoded([with_gaps(pgn, rng) for _ in range(40)])
    frames = [(k * 10**8 + j, f) for k, each in enumerate(packets) for j, f in enumerate(each)]
    theirs = canboat.decoded(frames)
    assert len(theirs) == len(packets)
    seen = set()
    for message, packet in zip(theirs, packets, strict=True):
        decoder = Decoder({})
        *_, found = [decoder.decode(frame) for frame in packet]
        fields = message["fields"]
        if pgn in REPORTS:
            read, names = report(pgn, found.fields), REPORTS[pgn]
            assert read["mmsi"] == int(fields["userId"])
            assert read.get("name", "") == (fields.get("name") or fields.get("atonName") or "")
        else:
            read, names = READERS[pgn](found.fields), FROM_CANBOAT[pgn]
        for name, value in read.items():
            if value is None or name not in names:
                continue
            seen.add(name)
            wanted = names[name] if isinstance(names[name], tuple) else (names[name],)
            given = value if isinstance(value, (tuple, list)) else (value,)
            for one, field in zip(given, wanted, strict=False):
                expected = fields[field] * UNITS.get(name, 1.0)
                if name == "magnetic_heading":
                    expected += fields.get("deviation") or 0.0
                if name in ("wind_angle", "water_wind_angle"):
                    expected = math.remainder(expected - math.pi, math.tau)
                assert one == pytest.approx(expected, rel=2e-3 if "engine_s" in name else 1e-6,
                                            abs=1e-7), name  # fmt: skip
        for name, field in names.items():  # what canboat has, the reader has
            if isinstance(field, str) and fields.get(field) is not None and name in read:
                assert read[name] is not None, name
    assert seen >= {n for n in names if n != "name"} - {"ground_wind_angle"} or pgn in REPORTS


@pytest.mark.parametrize(
    ("pgn", "length", "beam", "name"),
    [
        (129040, "length", "beam", "name"),
        (129041, "lengthDiameter", "beamDiameter", "atonName"),
        (129809, None, None, "name"),
        (129810, "length", "beam", None),
    ],
)
def test_names_and_sizes_of_stations_are_on_the_outputs(pgn, length, beam, name):
    """Messages that canboat writes; a node shows what canboat reads in their frames."""
    rng = random.Random(pgn)
    network = Network({"node": {}})
    network.run(1.0)
    place = {"userId": 244670316, "latitude": 0.01, "longitude": 0.02}
    given = {length: rng.uniform(5, 300), beam: rng.uniform(2, 40), name: "NOORD 12"}
    fields = place | {field: value for field, value in given.items() if field is not None}
    if pgn > 129800:  # static data have no place
        (report,) = canboat.encoded([{"pgn": 129039, "src": 7, "dst": 255, "fields": place}])
        for frame in report:
            network.send(frame)
        network.run(0.1)
        del fields["latitude"], fields["longitude"]
    (frames,) = canboat.encoded([{"pgn": pgn, "src": 7, "dst": 255, "prio": 4, "fields": fields}])
    for frame in frames:
        network.send(frame)
    network.run(0.1)
    (read,) = (m["fields"] for m in canboat.decoded(enumerate(frames)))
    node = network.nodes["node"]
    assert node.get("bus_ais_mmsi")[0] == read["userId"]
    for port, field in (("length", length), ("beam", beam)):
        if field is not None:
            assert read[field] == pytest.approx(given[field], abs=0.0501)
            assert node.get(f"bus_ais_{port}")[0] == pytest.approx(read[field], abs=1e-9)
    if name is not None:
        assert node.get("bus_ais_names") == f"244670316 {read[name]}"


def test_a_pressure_that_is_set_is_on_the_outputs():
    network = Network({"node": {}})
    network.run(1.0)
    fields = {"instance": 1, "source": "Hydraulic", "pressure": 1234567.8}
    (frames,) = canboat.encoded([{"pgn": 130315, "src": 7, "dst": 255, "fields": fields}])
    network.send(*frames)
    network.run(0.1)
    (read,) = (m["fields"] for m in canboat.decoded(enumerate(frames)))
    node = network.nodes["node"]
    assert node.get("bus_set_pressure_valid")
    assert node.get("bus_set_pressure") == pytest.approx(read["pressure"], abs=1e-6)
    assert read["pressure"] == pytest.approx(fields["pressure"], abs=0.0501)


@pytest.mark.parametrize(
    ("pgn", "fields", "length", "left"),
    [
        (127250, ("heading", "deviation", "variation"), 3, 1),
        (127250, ("heading", "deviation", "variation"), 5, 2),
        (127250, ("heading", "deviation", "variation"), 6, 2),
        (127251, ("rate",), 1, 0),
        (127257, ("yaw", "pitch", "roll"), 5, 2),
        (128259, ("speedWaterReferenced", "speedGroundReferenced"), 3, 1),
    ],
)
def test_fields_behind_the_end_of_a_short_frame_are_absent(pgn, fields, length, left):
    message = {"pgn": pgn, "src": 7, "dst": 255, "prio": 2, "fields": dict.fromkeys(fields, 0.5)}
    ((whole,),) = canboat.encoded([message])
    short = replace(whole, data=whole.data[:length])
    (theirs,) = canboat.decoded([(0, short)])
    ours = Decoder({}).decode(short).fields
    for frame_fields in (theirs["fields"], ours):
        assert [frame_fields.get(name) is not None for name in fields] == [
            k < left for k in range(len(fields))
        ]
