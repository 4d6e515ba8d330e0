"""Sentences of sensors and plotters, read into quantities; the textbook's examples and pynmea2's."""

import math

import pynmea2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.nmea.nmea0183.quantities import READERS

from .bench import DEG, KNOT, VALID, Bench

MILE = 1852.0
HOME = {"latitude": 48.0 * DEG, "longitude": 11.5 * DEG, "sentences": ""}


def line(text, talker="II"):
    """Return a sentence from its formatter and fields; pynmea2 has the checksum."""
    formatter, *fields = text.split(",")
    body = ",".join((talker + formatter, *fields))
    return f"${body}*{pynmea2.NMEASentence.checksum(body):02X}\r\n".encode()


def received(*sentences, **values):
    bench = Bench(**{**HOME, **values})
    bench.receive(*map(line, sentences))
    bench.run(0.2)
    return bench.one


def get(one, name):
    return one.get(f"received_{name}") if one.get(f"received_{name}_valid") else None


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        ("HDT,123.5,T", {"heading": 123.5 * DEG}),
        ("THS,123.5,A", {"heading": 123.5 * DEG}),
        ("THS,123.5,V", {"heading": None}),
        ("HDG,98.3,1.0,E,12.6,W", {"heading": 86.7 * DEG, "magnetic_heading": 99.3 * DEG,
                                   "variation": -12.6 * DEG}),
        ("HDG,98.3,,,12.6,E", {"heading": 110.9 * DEG, "magnetic_heading": 98.3 * DEG}),
        ("ROT,-30.0,A", {"rate_of_turn": -0.5 * DEG}),
        ("ROT,-30.0,V", {"rate_of_turn": None}),
        ("RSA,10.5,A,,V", {"rudder": 10.5 * DEG}),
        ("RSA,10.5,V,,V", {"rudder": None}),
        ("VHW,245.1,T,245.1,M,000.01,N,000.01,K", {"water_speed": 0.01 * KNOT,
                                                   "heading": 245.1 * DEG}),
        ("VHW,,T,,M,,N,7.2,K", {"water_speed": 2.0, "heading": None}),
        ("VBW,4.0,,A,3.0,,A", {"water_speed": 4.0 * KNOT}),
        ("VBW,4.0,,V,3.0,,A", {"water_speed": None}),
        ("DPT,76.1,0.5,100", {"depth": 76.1, "depth_offset": 0.5}),
        ("DPT,,0.5,", {"depth": None, "depth_offset": 0.5}),
        ("DBT,7.8,f,2.4,M,1.3,F", {"depth": 2.4}),
        ("DBT,10.0,f,,M,,F", {"depth": 3.048}),
        ("MTW,15.2,C", {"water_temperature": 288.35}),
        ("MWV,90.0,R,10.0,N,A", {"wind_speed": 10.0 * KNOT, "wind_angle": -math.pi / 2}),
        ("MWV,270.0,R,36.0,K,A", {"wind_speed": 10.0, "wind_angle": math.pi / 2}),
        ("MWV,90.0,R,5.0,M,V", {"wind_speed": None, "wind_angle": None}),
        ("MWV,,R,5.0,M,A", {"wind_speed": 5.0, "wind_angle": None, "wind": None}),
        ("VWR,90.0,L,10.0,N,5.1,M,18.5,K", {"wind_speed": 5.1, "wind_angle": math.pi / 2}),
        ("RPM,E,1,2418.2,10.5,A", {}),
        ("VDR,90.0,T,100.0,M,2.0,N", {"current_speed": 2.0 * KNOT,
                                      "current_direction": 90.0 * DEG}),
        ("XTE,A,A,0.67,L,N", {"cross_track": 0.67 * MILE}),
        ("XTE,A,A,0.67,R,N", {"cross_track": -0.67 * MILE}),
        ("XTE,V,A,0.67,R,N", {"cross_track": None}),
        ("BOD,45.0,T,30.0,M,DEST,START", {"leg_direction": 45.0 * DEG}),
        ("BWC,081837,,,,,50.0,T,,M,3.0,N,TEST", {"waypoint_bearing": 50.0 * DEG,
                                                 "waypoint_distance": 3.0 * MILE,
                                                 "waypoint": None}),
        ("VTG,054.7,T,034.4,M,005.5,N,010.2,K", {"course": 54.7 * DEG,
                                                 "speed_over_ground": 5.5 * KNOT}),
        ("VTG,,T,,M,,N,18.0,K,A", {"course": None, "speed_over_ground": 5.0}),
        ("VTG,054.7,T,034.4,M,005.5,N,010.2,K,N", {"course": None, "speed_over_ground": None}),
        ("GGA,123519,4807.038,N,01131.000,E,0,08,0.9,545.4,M,46.9,M,,", {"position": None}),
        ("GLL,4916.45,N,12311.12,W,225444,V", {"position": None}),
        ("GNS,014035.00,4807.0,N,01131.0,E,NN,00,,,,,", {"position": None}),
        ("XDR,A,-1.5,D,PTCH,A,3.0,D,ROLL", {"pitch": None, "roll": None, "attitude": None}),
        ("XDR,C,12.0,C,ENV_OUTAIR_T,P,1.013,B,Barometer", {"air_temperature": 285.15,
                                                           "air_pressure": 101300.0}),
        ("MDA,29.92,I,1.013,B,20.0,C,18.0,C,50,,10.0,C,180.0,T,,M,10.0,N,5.1,M",
         {"air_pressure": 101300.0, "air_temperature": 293.15, "water_temperature": 291.15,
          "humidity": 0.5}),
    ],
)  # fmt: skip
def test_a_sentence_is_its_quantities(sentence, expected):
    one = received(sentence)
    for name, value in expected.items():
        if name in ("pitch", "roll", "attitude"):
            continue
        found = get(one, name) if name not in ("wind", "position", "waypoint") else None
        if name in ("wind", "position", "waypoint"):
            assert not one.get(f"received_{name}_valid")
        elif value is None:
            assert found is None, name
        else:
            assert found == pytest.approx(value, rel=1e-9), name


def test_fixes_winds_engines_and_attitude():
    one = received(
        "RMC,123519,A,4807.038,N,01131.000,E,022.4,090.0,230394,003.1,W",
        "MWD,90.0,T,,M,10.0,N,,M",
        "RPM,E,2,1200,,A",
        "XDR,A,-1.5,D,PTCH,A,3.0,D,ROLL",
    )
    north, east, _ = one.get("received_position_n")
    assert north == pytest.approx(0.1173 * 60 * MILE, rel=5e-3)
    assert east == pytest.approx(1.0 / 60.0 * 60 * MILE * math.cos(48.1 * DEG), rel=5e-3)
    assert one.get("received_velocity_n") == pytest.approx([0.0, 22.4 * KNOT, 0.0], abs=1e-9)
    assert one.get("received_true_wind") == pytest.approx([0.0, -10.0 * KNOT], abs=1e-9)
    assert one.get("received_engine_speed")[1] == pytest.approx(1200 * math.tau / 60)
    assert one.get("received_attitude")[:2] == pytest.approx([3.0 * DEG, -1.5 * DEG])
    assert (one.get("received_roll_valid"), one.get("received_yaw_valid")) == (True, False)
    assert one.get("received_variation") == pytest.approx(-3.1 * DEG)


def test_a_magnetic_compass_has_the_variation_of_another_talker_or_the_model():
    alone = received("HDM,100.0,M", latitude=0.0, longitude=0.0)
    assert not alone.get("received_heading_valid")
    given = received("HDM,100.0,M", variation=5.0 * DEG)
    assert get(given, "heading") == pytest.approx(105.0 * DEG)
    assert given.get("received_heading_from") == "magnetic HDM from II, the parameter variation"
    network = received(
        "HDM,100.0,M", "RMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"
    )
    assert get(network, "heading") == pytest.approx(96.9 * DEG)
    model = received("HDM,100.0,M", "GLL,4807.038,N,01131.000,E,225444,A", date="2024-06-01")
    assert get(model, "heading") == pytest.approx(104.2 * DEG, abs=0.5 * DEG)  # NOAA: Munich
    assert "World Magnetic Model" in model.get("received_heading_from")


def test_talkers_have_priorities_and_hand_over():
    bench = Bench(**HOME, prefer="heading HE HC", timeout=1.0)
    bench.receive(line("HDT,10.0,T", "HC"))
    bench.run(0.2)
    assert get(bench.one, "heading") == pytest.approx(10.0 * DEG)
    bench.receive(line("HDT,20.0,T", "HE"), line("HDT,11.0,T", "HC"))
    bench.run(0.2)
    assert get(bench.one, "heading") == pytest.approx(20.0 * DEG)
    assert "heading HE" in bench.one.get("received_sources")
    bench.run(1.5)
    assert get(bench.one, "heading") is None
    bench.receive(line("HDT,11.0,T", "HC"))
    bench.run(0.2)
    assert get(bench.one, "heading") == pytest.approx(11.0 * DEG)


def test_magnetic_orders_have_the_variation_of_the_network():
    one = received("HDG,98.3,,,10.0,E", "HSC,,T,100.0,M")
    assert one.get("target_heading") == pytest.approx(110.0 * DEG)
    assert get(one, "heading_to_steer") == pytest.approx(110.0 * DEG)


def test_other_ships_are_targets_and_sentences_are_counted():
    bench = Bench(**HOME)
    bench.receive(
        b"!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C\r\n",
        line("HDT,10.0,T"),
        line("HDT,,T"),
        line("TXT,01,01,02,HELLO"),
    )
    bench.run(0.2)
    assert bench.one.get("received_ais_targets") == 1
    assert bench.one.get("received_ais_mmsi")[0] == 477553000
    assert bench.one.get("received_messages") == "HDT 1/2; VDM 1/1"
    assert bench.one.get("received_others") == "TXT 1"


def test_a_talker_and_a_listener_agree():
    talker, listener = Bench(variation=-3.0 * DEG), Bench(sentences="")
    talker.set(**VALID)
    lines = talker.run(1.05)
    listener.receive(*lines)
    listener.run(0.1)
    one, half = listener.one, 0.006 * DEG
    assert one.get("received_position_n")[:2] == pytest.approx([100.0, -50.0], abs=0.02)
    assert one.get("received_velocity_n")[:2] == pytest.approx([1.0, -0.5], abs=0.006)
    assert get(one, "heading") == pytest.approx(350.0 * DEG, abs=half)
    assert get(one, "magnetic_heading") == pytest.approx(353.0 * DEG, abs=half)
    assert get(one, "rate_of_turn") == pytest.approx(3.0 * DEG, abs=1e-5)
    assert one.get("received_attitude")[:2] == pytest.approx([5.0 * DEG, -2.0 * DEG], abs=half)
    assert get(one, "wind_speed") == pytest.approx(6.0, abs=0.003)
    assert get(one, "wind_angle") == pytest.approx(-135.0 * DEG, abs=half)
    assert one.get("received_true_wind") == pytest.approx([-4.0, -3.0], abs=0.01)
    assert get(one, "water_speed") == pytest.approx(1.25, abs=0.003)
    assert get(one, "depth") == pytest.approx(12.34, abs=0.003)
    assert get(one, "water_temperature") == pytest.approx(295.65, abs=0.006)
    assert get(one, "rudder") == pytest.approx(-7.5 * DEG, abs=half)
    assert get(one, "cross_track") == pytest.approx(100.0, abs=10.0)  # RMB: 0.01 miles
    assert get(one, "waypoint_bearing") == pytest.approx(-math.atan2(100, 900) % math.tau, abs=half)
    assert one.get("received_waypoint_n")[:2] == pytest.approx([1000.0, -150.0], abs=0.02)
    assert one.get("received_engine_speed")[1] == pytest.approx(100.0, abs=0.01)
    assert one.get("received_others") == "GSA 2; GSV 4; VLW 2"


@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from(sorted(READERS)),
    st.lists(st.sampled_from(["", "A", "V", "T", "M", "N", "K", "1", "0.5", "-7.25", "359.9",
                              "4807.038", "1e300", "nan", "D", "PTCH", "E", "W", "230394"]),
             max_size=16),
)  # fmt: skip
def test_any_fields_may_be_absent_or_odd(formatter, fields):
    """Nothing raises, and what is shown is finite."""
    bench = Bench(**HOME)
    body = ",".join((f"II{formatter}", *fields))
    bench.receive(f"${body}*{pynmea2.NMEASentence.checksum(body):02X}\r\n".encode())
    bench.run(0.1)
    numbers = [v for v in bench.one.values if isinstance(v, float)]
    assert all(map(math.isfinite, numbers))


@pytest.mark.parametrize(
    ("prefer", "message"),
    [
        ("headin HE", "did you mean 'heading'"),
        ("heading HE; heading HC", "is there twice"),
        ("heading", "has no source"),
    ],
)
def test_mistakes_in_priorities(prefer, message):
    with pytest.raises(Exception, match=message):
        Bench(**HOME, prefer=prefer)
