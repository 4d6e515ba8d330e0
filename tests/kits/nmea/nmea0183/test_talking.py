"""Sent sentences, read by pynmea2, which did not write them."""

import datetime
import math

import pymap3d
import pynmea2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.links.text import encode as chunks
from seatrial_kits.nmea.nmea0183.codec import encode
from seatrial_kits.nmea.nmea0183.readings import Readings
from seatrial_kits.nmea.nmea0183.sentences import SENTENCES

from .bench import ALL, DEG, KNOT, VALID, Bench, read

HOME = {"latitude": -22.862 * DEG, "longitude": -43.223 * DEG, "altitude": 2.0}


def test_every_sentence_says_what_the_inputs_are():
    bench = Bench(**HOME, variation=-23.0 * DEG, transducer_offset=0.4, date="2018-09-01")
    bench.set(**VALID)
    bench.run(61.0)
    sent = read(bench.run(1.05))
    latitude, longitude, _ = pymap3d.ned2geodetic(100.0, -50.0, 0.0, -22.862, -43.223, 2.0)
    rmc, gga, vtg = sent["GPRMC"], sent["GPGGA"], sent["GPVTG"]
    gll, zda = sent["GPGLL"], sent["GPZDA"]
    for fix in (rmc, gga, gll):
        assert fix.latitude == pytest.approx(latitude, abs=1e-7)
        assert fix.longitude == pytest.approx(longitude, abs=1e-7)
        assert fix.timestamp.replace(tzinfo=None) == datetime.time(0, 1, 2)
    assert rmc.datetime.replace(tzinfo=None) == datetime.datetime(2018, 9, 1, 0, 1, 2)
    assert zda.datetime == datetime.datetime(2018, 9, 1, 0, 1, 2, tzinfo=datetime.UTC)
    assert (rmc.status, rmc.mode_indicator, gga.gps_qual) == ("A", "A", 1)
    assert (gll.status, gll.faa_mode) == ("A", "A")
    speed, course = math.hypot(1.0, 0.5), math.degrees(math.atan2(-0.5, 1.0)) + 360.0
    assert float(rmc.spd_over_grnd) == pytest.approx(speed / KNOT, abs=0.005)
    assert float(rmc.true_course) == pytest.approx(course, abs=0.005)
    assert (rmc.mag_variation, rmc.mag_var_dir) == ("23.0", "W")
    assert gga.altitude == pytest.approx(3.5)
    assert float(vtg.true_track) == pytest.approx(course, abs=0.005)
    assert float(vtg.mag_track) == pytest.approx((course + 23.0) % 360.0, abs=0.01)
    assert float(vtg.spd_over_grnd_kmph) == pytest.approx(speed * 3.6, abs=0.005)
    assert float(sent["HEHDT"].heading) == 350.0
    assert float(sent["HCHDG"].heading) == 13.0  # true 350 = magnetic 13 + variation -23
    assert (float(sent["HCHDG"].variation), sent["HCHDG"].var_dir) == (23.0, "W")
    assert float(sent["TIROT"].rate_of_turn) == 180.0  # degrees per minute
    apparent, true = sent["WIMWV-R"], sent["WIMWV-T"]
    assert (float(apparent.wind_angle), apparent.status) == (45.0, "A")
    assert float(apparent.wind_speed) * KNOT == pytest.approx(6.0, abs=0.005)
    # Blowing to (-4, -3) it comes from 36.87 degrees; that is 46.87 from a bow at 350.
    assert float(true.wind_angle) == pytest.approx(46.87, abs=0.01)
    assert float(true.wind_speed) * KNOT == pytest.approx(5.0, abs=0.005)
    assert sent["IIXDR"].data == ["A", "-2.00", "D", "PTCH", "A", "5.00", "D", "ROLL"]
    assert float(sent["VWVHW"].water_speed_knots) * KNOT == pytest.approx(1.25, abs=0.005)
    assert float(sent["VWVHW"].heading_magnetic) == 13.0
    assert float(sent["SDDBT"].depth_meters) == 12.34
    assert float(sent["SDDBT"].depth_feet) * 0.3048 == pytest.approx(12.34, abs=0.002)
    assert float(sent["SDDBT"].depth_fathoms) * 1.8288 == pytest.approx(12.34, abs=0.01)
    assert (float(sent["SDDPT"].depth), float(sent["SDDPT"].offset)) == (12.34, 0.4)
    assert float(sent["YXMTW"].temperature) == 22.5
    assert (float(sent["AGRSA"].rsa_starboard), sent["AGRSA"].rsa_starboard_status) == (-7.5, "A")


def test_satellites_and_the_leg_that_is_followed():
    bench = Bench(**HOME, date="2018-09-01")
    bench.set(**VALID)
    lines = bench.run(0.1)
    views = [pynmea2.parse(line.decode()) for line in lines if line[3:6] == b"GSV"]
    sent = read(lines)
    gga, gsa = sent["GPGGA"], sent["GPGSA"]
    in_view = int(views[0].num_sv_in_view)
    assert [(v.num_messages, v.msg_num) for v in views] == [
        (str(len(views)), str(k + 1)) for k in range(len(views))
    ]
    listed = [getattr(v, f"sv_prn_num_{k}", "") for v in views for k in range(1, 5)]
    numbers = [number for number in listed if number]
    assert len(numbers) == in_view == int(gga.num_sats)
    used = [getattr(gsa, f"sv_id{k:02}") for k in range(1, 13)]
    assert [number for number in used if number] == numbers
    assert (gsa.mode, gsa.mode_fix_type, gsa.hdop) == ("A", "3", gga.horizontal_dil)
    assert float(gsa.pdop) == pytest.approx(math.hypot(float(gsa.hdop), float(gsa.vdop)), abs=0.08)
    assert all(5 <= int(v.elevation_deg_1) <= 90 and int(v.azimuth_1) < 360 for v in views)
    # 100 m to starboard of a leg to the north: steer to port, 900 m north and 100 m west to go.
    xte, rmb = sent["AGXTE"], sent["AGRMB"]
    assert (float(xte.cross_track_err_dist), xte.correction_dir) == (0.054, "L")
    assert (rmb.status, rmb.arrival_alarm) == ("A", "V")
    latitude, longitude, _ = pymap3d.ned2geodetic(1000.0, -150.0, 0.0, -22.862, -43.223, 2.0)
    assert rmb.data[5:9] == [rmb.dest_lat, rmb.dest_lat_dir, rmb.dest_lon, rmb.dest_lon_dir]
    assert -(22 + float(rmb.dest_lat[2:]) / 60.0) == pytest.approx(latitude, abs=2e-7)
    assert -(43 + float(rmb.dest_lon[3:]) / 60.0) == pytest.approx(longitude, abs=2e-7)
    assert float(rmb.dest_range) * 1852.0 == pytest.approx(math.hypot(900.0, 100.0), abs=10.0)
    assert float(rmb.dest_true_bearing) == pytest.approx(360.0 - 6.34, abs=0.01)


@pytest.mark.slow
def test_sentences_for_plotters_and_autopilots():
    """The leg runs north, 100 m to port of the boat; she goes north at 1 m/s, 0.5 m/s west."""
    bench = Bench(**HOME, variation=-23.0 * DEG, date="2018-09-01")
    bench.set(**VALID)
    bench.run(1000.0)
    sent = read(bench.run(1.05))
    apb, bwc, bod = sent["AGAPB"], sent["AGBWC"], sent["AGBOD"]
    assert (apb.status_gen, apb.status_cycle_lock) == ("A", "A")
    assert (float(apb.cross_track_err_mag), apb.dir_steer, apb.cross_track_unit) == (
        0.054,
        "L",
        "N",
    )
    assert (apb.arr_circle_entered, apb.perp_passed) == ("V", "V")
    assert (float(apb.bearing_to_dest), apb.bearing_type) == (0.0, "T")
    bearing = 360.0 - math.degrees(math.atan2(100.0, 900.0))
    assert float(apb.bearing_pres_dest) == pytest.approx(bearing, abs=0.006)
    assert float(apb.heading_to_dest) == pytest.approx(bearing, abs=0.006)
    assert (apb.heading_to_dest_type, apb.dest_waypoint_id) == ("T", "WP2")
    assert float(bwc.true_track) == pytest.approx(bearing, abs=0.006)
    assert float(bwc.mag_track) == pytest.approx((bearing + 23.0) % 360.0, abs=0.01)
    assert float(bwc.range_next) * 1852.0 == pytest.approx(math.hypot(900.0, 100.0), abs=1.0)
    latitude, _, _ = pymap3d.ned2geodetic(1000.0, -150.0, 0.0, -22.862, -43.223, 2.0)
    assert -(22 + float(bwc.lat_next[2:]) / 60.0) == pytest.approx(latitude, abs=2e-7)
    assert (float(bod.bearing_t), float(bod.bearing_mag)) == (0.0, 23.0)
    assert (bod.dest, bod.start) == ("WP2", "WP1")
    assert float(sent["HCHDM"].heading) == 13.0
    mwd = sent["WIMWD"]  # it blows to (-4, -3): from 36.87 degrees
    assert float(mwd.direction_true) == pytest.approx(36.87, abs=0.01)
    assert float(mwd.direction_magnetic) == pytest.approx(59.87, abs=0.01)
    assert float(mwd.wind_speed_meters) == 5.0
    gns = sent["GNGNS"]
    assert gns.latitude == pytest.approx(sent["GPGGA"].latitude)
    assert (gns.mode_indicator, gns.num_sats) == ("A", sent["GPGGA"].num_sats)
    # 1.25 m/s through the water for 1001 s.
    assert float(sent["VWVLW"].trip_distance) * 1852.0 == pytest.approx(1251.0, abs=3.0)
    rpm = sent["ERRPM"]
    assert (rpm.source, rpm.engine_no, rpm.status) == ("E", 2, "A")
    assert float(rpm.speed) == pytest.approx(100.0 * 60.0 / math.tau, abs=0.06)
    # Over ground less 1.25 m/s on 350 degrees.
    north, east = 1.0 - 1.25 * math.cos(350 * DEG), -0.5 - 1.25 * math.sin(350 * DEG)
    vdr = sent["IIVDR"]
    assert float(vdr.deg_t) == pytest.approx(math.degrees(math.atan2(east, north)) % 360, abs=0.01)
    assert float(vdr.current) * KNOT == pytest.approx(math.hypot(north, east), abs=0.003)


def test_without_a_fix_there_are_no_satellites_and_no_leg():
    bench = Bench(**HOME)
    bench.set(**{**VALID, "position_valid": False})
    sent = read(bench.run(0.1))
    assert (sent["GPGSV"].num_sv_in_view, sent["GPGSA"].mode_fix_type) == ("00", "1")
    assert (sent["GPGGA"].num_sats, sent["GPGGA"].horizontal_dil) == ("00", "")
    assert sent["AGXTE"].warning_flag == "V"
    assert "AGRMB" not in sent


def test_sentences_of_a_transponder_go_out_as_they_are():
    line = b"!AIVDM,1,1,,A,15M67F@risvR:905jfnTlSpJ0000,0*11\r\n"
    bench = Bench(sentences="")
    bench.set(ais=chunks(1, [(0, line)]))
    assert bench.run(0.2) == [line]


def test_a_rudder_that_is_positive_to_port_has_the_other_sign_in_its_sentence():
    bench = Bench(rudder_positive="port")
    bench.set(**VALID)
    assert float(read(bench.run(1.05))["AGRSA"].rsa_starboard) == 7.5


def test_what_is_not_valid_is_empty_and_says_so():
    bench = Bench(**HOME)
    bench.set(**{name: value for name, value in VALID.items() if not name.endswith("_valid")})
    sent = read(bench.run(0.1))
    assert len(sent) == len(ALL.split(";")) - 2  # no RMB without a leg, no VDR
    assert (sent["GPRMC"].status, sent["GPRMC"].mode_indicator) == ("V", "N")
    assert sent["GPRMC"].is_valid is False
    assert (sent["GPGGA"].gps_qual, sent["GPVTG"].faa_mode) == (0, "N")
    assert (sent["GPGLL"].status, sent["GPGLL"].faa_mode) == ("V", "N")
    assert sent["GPZDA"].datetime.year == 2020  # the clock goes on
    for name in ("GPRMC", "GPGGA", "GPGLL"):
        assert (sent[name].lat, sent[name].lat_dir, sent[name].lon, sent[name].lon_dir) == ("",) * 4
    for name in ("TIROT", "WIMWV-R", "WIMWV-T"):
        assert sent[name].status == "V"
    assert sent["AGRSA"].rsa_starboard_status == "V"
    for name, field in {
        "GPRMC": "spd_over_grnd",
        "GPVTG": "true_track",
        "HEHDT": "heading",
        "HCHDG": "heading",
        "TIROT": "rate_of_turn",
        "WIMWV-R": "wind_angle",
        "WIMWV-T": "wind_speed",
        "VWVHW": "water_speed_knots",
        "SDDBT": "depth_meters",
        "SDDPT": "depth",
        "YXMTW": "temperature",
        "AGRSA": "rsa_starboard",
    }.items():
        assert not getattr(sent[name], field), name


def test_what_nothing_is_connected_to_is_empty_whatever_its_flag_says():
    """An AHRS without a gyro says that it is valid, and a rig gives rudder_valid to all vehicles."""
    bench = Bench(**HOME)
    lacking = ("rate_of_turn", "roll_pitch", "rudder")
    bench.set(**{name: value for name, value in VALID.items() if name not in lacking})
    sent = read(bench.run(0.1))
    assert (sent["TIROT"].status, sent["AGRSA"].rsa_starboard_status) == ("V", "V")
    assert not sent["TIROT"].rate_of_turn
    assert not sent["AGRSA"].rsa_starboard


def test_a_reading_that_fails_and_comes_back():
    bench = Bench(**HOME, sentences="GPRMC 0.1")
    bench.set(**VALID)
    assert read(bench.run(0.1))["GPRMC"].is_valid
    bench.set(position_valid=False)
    assert not read(bench.run(0.1))["GPRMC"].is_valid
    bench.set(position_valid=True)
    assert read(bench.run(0.1))["GPRMC"].is_valid


_ANGLES = st.floats(-math.tau, 2.0 * math.tau)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-90.0, 90.0),
    st.floats(-180.0, 180.0),
    _ANGLES,
    st.floats(-100.0, 100.0),
    st.floats(-math.pi, math.pi),
    st.datetimes(datetime.datetime(2000, 1, 1), datetime.datetime(2068, 12, 31)),
)
def test_all_values_come_back(latitude, longitude, heading, speed, variation, time):
    """Ends of ranges too: 59.999999 minutes, 359.999 degrees, minus zero."""
    readings = Readings(
        time,
        variation,
        position=(latitude, longitude, 0.0),
        velocity=(speed, -speed),
        heading=heading,
        apparent_wind=(abs(speed), heading),
    )
    sent = read(
        [
            encode("GP", name[:3], SENTENCES[name](readings)[0])
            for name in ("RMC", "GGA", "HDT", "HDG", "MWV-R")
        ]
    )
    for name in ("GPRMC", "GPGGA"):
        assert sent[name].latitude == pytest.approx(latitude, abs=1e-7)
        assert sent[name].longitude == pytest.approx(longitude, abs=1e-7)
        assert float(sent[name].lat[-8:]) < 60.0
    for text, wanted in (
        (sent["GPHDT"].heading, heading),
        (sent["GPHDG"].heading, heading - variation),
        (sent["GPMWV-R"].wind_angle, heading),
    ):
        assert 0.0 <= float(text) < 360.0
        away = (float(text) - math.degrees(wanted) + 180.0) % 360.0 - 180.0
        assert away == pytest.approx(0.0, abs=0.0051)
    assert sent["GPRMC"].spd_over_grnd >= 0.0
    assert sent["GPRMC"].datetime.date() == time.date()


def test_rates_do_not_depend_on_the_step():
    runs = []
    for step_ns in (50_000_000, 200_000_000, 1_000_000_000):
        bench = Bench(**HOME, sentences="GPRMC 1; HEHDT 0.1; WIMWV-R 0.25")
        bench.set(**VALID)
        bench.run(10.0, step_ns)
        runs.append(bench.sent)
    assert runs[0] == runs[1] == runs[2]
    times = {
        name: [when for when, data in runs[0] if name in data] for name in (b"RMC", b"HDT", b"MWV")
    }
    assert times[b"RMC"] == [k * 10**9 for k in range(10)]
    assert times[b"HDT"] == [k * 10**8 for k in range(100)]
    assert times[b"MWV"] == [k * 25 * 10**7 for k in range(40)]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"sentences": "GPRMV 1"}, "unknown sentence 'RMV'; did you mean 'RPM' or 'RMC'"),
        ({"sentences": "GPMWV 1"}, "did you mean 'MWV-T' or 'MWV-R'"),
        ({"sentences": "GPRMC"}, "'GPRMC' is not TALKER+SENTENCE PERIOD"),
        ({"sentences": "gprmc 1"}, "'gprmc 1' is not TALKER+SENTENCE PERIOD"),
        ({"sentences": "GPRMC 0"}, "'GPRMC 0': the period is above 0"),
        ({"sentences": "GPRMC 1; GPRMC 2"}, "GPRMC is named twice"),
        ({"date": "1.9.2018"}, "date is '1.9.2018'"),
        ({"links": "udp:127.0.0.1:10110"}, "did you mean"),
        ({"links": "serial:/dev/nowhere:4800"}, "'serial:/dev/nowhere:4800'"),
    ],
)
def test_mistakes(values, expected):
    with pytest.raises(InputError) as caught:
        Bench(**values)
    assert expected in str(caught.value)
    assert str(caught.value).startswith("nmea")


def test_checksums_are_right_by_hand():
    """XOR of all between $ and *."""
    bench = Bench()
    bench.set(**VALID)
    for each in bench.run(0.1):
        body, _, checksum = each.strip()[1:].partition(b"*")
        xor = 0
        for octet in body:
            xor ^= octet
        assert int(checksum, 16) == xor
        with pytest.raises(pynmea2.ChecksumError):
            pynmea2.parse(each.decode().replace("*", "0*").strip(), check=True)
