import math

import pytest

from seatrial.devices.actuators.servo import Servo
from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class
from seatrial.shipped import provided_folders
from seatrial.system.profile.profile import Profiles, check_profile, load_profile
from tests.kit import OF_PROFILES, needs_kits

pytestmark = needs_kits("mavlink")

GOOD = """\
title = "A boat"

[identity]
system_id = 7
component_id = 1
vehicle_type = "surface_boat"
autopilot_type = "px4"
firmware_version = "1.2.3-dev"
uid = 0xFFFF_FFFF_FFFF_FFFF

[home]
latitude = "-31.78 deg"
longitude = "-0.5 rad"
altitude = "120 cm"
date = 2026-02-05
source = "assumed"

[actuators.port]
channel = 1
port = "port_thruster.pulse"
pulse_min = "1100 us"
pulse_neutral = "1.5 ms"
pulse_max = "0.0019 s"
source = "data sheet"

[actuators.rudder]
channel = 2
port = "rudder.pulse"
pulse_min = "1000 us"
pulse_neutral = "1500 us"
pulse_max = "2000 us"
reversed = true
source = "data sheet"

[sensors.gnss]
kind = "gnss"
source = "data sheet"
period = "200 ms"
antenna = ["10 cm", "0 m", "-300 mm"]
position_n_noise = "2 cm"
dropout = 0.01

[sensors.heading]
kind = "compass"
source = "data sheet"
heading_noise = "0.5 deg"

[links.ground]
kind = "mavlink"
links = "udpin:127.0.0.1:0 tcpin:127.0.0.1:0"
station_timeout = "10 s"
failsafe = "return"
"""

ACTUATORS_AND_SENSORS = GOOD[GOOD.index("[actuators.port]") : GOOD.index("[links.ground]")]


@pytest.fixture
def load(write):
    """Return a function that reads GOOD with one text replaced by another."""

    def load(old="", new=""):
        assert not old or GOOD.count(old) == 1
        return check_profile("boat.toml", write("boat.toml", GOOD.replace(old, new)).parent)

    return load


def test_values_are_si(load):
    profile = load()
    assert profile.file.identity.uid == 2**64 - 1
    assert profile.file.home.latitude == pytest.approx(math.radians(-31.78))
    assert profile.file.home.longitude == -0.5
    assert profile.file.home.altitude == pytest.approx(1.2)
    assert profile.parameters("sensors.gnss") == {
        "period": 0.2,
        "antenna": [0.1, 0.0, -0.3],
        "position_n_noise": 0.02,
        "dropout": 0.01,
    }
    assert profile.parameters("sensors.heading") == {"heading_noise": math.radians(0.5)}
    assert profile.parameters("actuators.port") == {
        "pulse_min": 1.1e-3,
        "pulse_neutral": 1.5e-3,
        "pulse_max": 1.9e-3,
        "reversed": 0.0,
    }
    assert profile.parameters("actuators.rudder")["reversed"] == 1.0


def test_a_link_knows_the_whole_vehicle(load):
    assert load().parameters("links.ground") == {
        "system_id": 7.0,
        "component_id": 1.0,
        "vehicle_type": "surface_boat",
        "autopilot_type": "px4",
        "firmware_version": "1.2.3-dev",
        "uid": str(2**64 - 1),
        "latitude": pytest.approx(math.radians(-31.78)),
        "longitude": -0.5,
        "altitude": pytest.approx(1.2),
        "date": "2026-02-05",
        "actuators": "1 port 1100 1500 1900; 2 rudder 1000 1500 2000 reversed",
        "links": "udpin:127.0.0.1:0 tcpin:127.0.0.1:0",
        "station_timeout": 10.0,
        "failsafe": "return",
    }


def test_sections(load):
    sections = ["actuators.port", "actuators.rudder", "sensors.gnss", "sensors.heading"]
    assert load().sections() == [*sections, "links.ground"]


def test_unknown_section_has_near_misses(load):
    with pytest.raises(
        InputError, match=r"boat\.toml: unknown section 'sensors.gps'; did you mean"
    ):
        load().parameters("sensors.gps")


def test_a_sensorless_profile_is_fine(write):
    text = GOOD[: GOOD.index("[actuators.port]")]
    assert load_profile("bare.toml", write("bare.toml", text).parent).sections() == []


def bare(write, text):
    return check_profile("bare.toml", write("bare.toml", f'title = "bare"\n{text}').parent)


def test_what_a_rig_does_not_use_may_be_left_out(write):
    text = "".join(
        f"{line}\n" for line in ACTUATORS_AND_SENSORS.splitlines() if "source" not in line
    )
    profile = bare(write, text)
    assert profile.parameters("sensors.heading") == {"heading_noise": math.radians(0.5)}
    assert profile.source("sensors.heading") == "no source given"
    assert profile.notes("sensors.heading") == ["profile bare: sensors.heading has no source"]
    assert profile.notes("actuators.port") == ["profile bare: actuators.port has no source"]


def test_defaults_of_identity_and_home_are_those_of_the_link_and_are_reported(write):
    profile = bare(write, '[links.ground]\nkind = "mavlink"\n[identity]\nsystem_id = 7\n')
    values, ports = profile.parameters("links.ground"), component_class("mavlink").ports
    assert values.pop("system_id") == 7.0
    assert values == {name: ports[name].start[0] for name in values}
    assert profile.notes("links.ground") == [
        "profile bare: links.ground has defaults for what [identity] and [home] do not say: "
        "component_id = 1.0, vehicle_type = surface_boat, autopilot_type = ardupilotmega, "
        "firmware_version = 0.1.0-dev, uid = 1, latitude = 0.0, longitude = 0.0, altitude = 0.0, "
        "date = 2026-01-01"
    ]


def test_a_full_profile_has_nothing_to_note(load):
    profile = load()
    assert [note for section in profile.sections() for note in profile.notes(section)] == []


# Each mistake, and what the message must say of it.
MISTAKES = {
    "unknown key": (
        ("system_id", "sytem_id"),
        ["identity.sytem_id", "did you mean 'system_id'"],
    ),
    "missing key": (("channel = 1\n", ""), ["actuators.port.channel", "missing"]),
    "unknown table": (("[home]", "[hone]"), ["hone", "did you mean 'home'"]),
    "id out of range": (("system_id = 7", "system_id = 256"), ["identity.system_id", "255", "256"]),
    "id as text": (("system_id = 7", 'system_id = "7"'), ["identity.system_id", "integer", "'7'"]),
    "vehicle type": (
        ('"surface_boat"', '"surfaceboat"'),
        ["identity.vehicle_type", "'surfaceboat'", "did you mean 'surface_boat'", "submarine"],
    ),
    "autopilot type": (('"px4"', '"pixhawk"'), ["identity.autopilot_type", "ardupilotmega, px4"]),
    "version": (('"1.2.3-dev"', '"v1"'), ["identity.firmware_version", "4.5.0-dev", "'v1'"]),
    "no unit": (('"-31.78 deg"', '"-31.78"'), ["home.latitude", "no unit", "'-31.78'"]),
    "bare number": (('"-31.78 deg"', "-31.78"), ["home.latitude", "unit", "-31.78"]),
    "latitude": (
        ('"-31.78 deg"', '"-91 deg"'),
        ["home.latitude", "at least -1.5708 rad", "-91 deg"],
    ),
    "date": (("2026-02-05", '"yesterday"'), ["home.date", "yesterday"]),
    "wrong unit": (('"1.5 ms"', '"1.5 m"'), ["actuators.port.pulse_neutral", "'m'", "'s'"]),
    "not a unit": (('"1.5 ms"', '"1.5 mx"'), ["actuators.port.pulse_neutral", "'mx'"]),
    "pulse range": (('"1.5 ms"', '"15 ms"'), ["actuators.port.pulse_neutral", "at most 0.0025 s"]),
    "pulse order": (('"1.5 ms"', '"2 ms"'), ["actuators.port", "must rise", "0.002"]),
    "channel range": (("channel = 2", "channel = 0"), ["actuators.rudder.channel", "1", "found 0"]),
    "channel twice": (
        ("channel = 2", "channel = 1"),
        ["actuators.rudder.channel", "1 is already actuators.port's"],
    ),
    "port twice": (
        ('"rudder.pulse"', '"port_thruster.pulse"'),
        ["actuators.rudder.port", "already driven by actuators.port"],
    ),
    "not a port": (
        ('"rudder.pulse"', '"rudder"'),
        ["actuators.rudder.port", "port_thruster.pulse"],
    ),
    "reversed as number": (("reversed = true", "reversed = 1"), ["actuators.rudder.reversed", "1"]),
    "kind": (('"compass"', '"compas"'), ["sensors.heading.kind", "did you mean 'compass'"]),
    "no kind": (('kind = "compass"\n', ""), ["sensors.heading.kind", "missing"]),
    "source no text": (
        ('kind = "compass"\nsource = "data sheet"', 'kind = "compass"\nsource = 3'),
        ["sensors.heading.source", "string", "found 3"],
    ),
    "sensor key": (
        ("heading_noise", "heading_nose"),
        ["sensors.heading.heading_nose", "did you mean 'heading_noise'"],
    ),
    "seed": (("dropout = 0.01", "seed = 1"), ["sensors.gnss.seed", "unknown key"]),
    "sensor without unit": (('"2 cm"', "0.02"), ["sensors.gnss.position_n_noise", "'1 m'", "0.02"]),
    "sensor limit": (
        ("dropout = 0.01", "dropout = 2"),
        ["sensors.gnss.dropout", "at most 1", "found 2"],
    ),
    "negative noise": (('"2 cm"', '"-2 cm"'), ["sensors.gnss.position_n_noise", "at least 0 m"]),
    "axes": (
        ('["10 cm", "0 m", "-300 mm"]', '["10 cm", "0 m"]'),
        ["sensors.gnss.antenna", "3 (x, y, z)"],
    ),
    "list for a scalar": (('"200 ms"', '["200 ms"]'), ["sensors.gnss.period", "one value needed"]),
    "unit in a list": (('"-300 mm"', '"-300 ms"'), ["sensors.gnss.antenna", "'ms'"]),
    "sensor no table": (("[sensors.heading]", "[sensors]\nx = 3\n[sensors.y]"), ["sensors.x.kind"]),
    "sensor name": (("[sensors.gnss]", '[sensors."a b"]'), ["sensors: 'a b' cannot be"]),
    "sensor name that is taken": (("[sensors.gnss]", "[sensors.copy]"), ["'copy' cannot be"]),
    "actuator name": (("[actuators.port]", '[actuators."a.b"]'), ["actuators", "'a.b'"]),
    "kind no text": (('kind = "gnss"', 'kind = ["gnss"]'), ["sensors.gnss.kind", "did you mean"]),
    "day and time": (("2026-02-05", "2026-02-05T10:00:00"), ["home.date", "2026"]),
    "no such day": (("2026-02-05", "2026-02-30"), ["not TOML", "line 15"]),
    "longitude": (('"-0.5 rad"', '"181 deg"'), ["home.longitude", "at most 3.14159 rad"]),
    "not a number": (("dropout = 0.01", "dropout = nan"), ["sensors.gnss.dropout", "nan"]),
    "zero period": (('"200 ms"', '"0 s"'), ["sensors.gnss.period", "at least 1e-06 s"]),
    "true for a number": (("channel = 2", "channel = true"), ["actuators.rudder.channel", "True"]),
    "title no text": (('title = "A boat"', "title = 3"), ["title", "string", "found 3"]),
    "kind of link": (('"mavlink"', '"mavlinks"'), ["links.ground.kind", "did you mean 'mavlink'"]),
    "link key": (
        ("station_timeout", "station_time"),
        ["links.ground.station_time", "did you mean 'station_timeout'"],
    ),
    "link key of the identity": (
        ('failsafe = "return"', "system_id = 3"),
        ["links.ground.system_id", "unknown key"],
    ),
    "URL": (
        ("tcpin:127.0.0.1:0", "tcp:127.0.0.1:0"),
        ["links.ground.links", "unknown kind of link 'tcp'", "did you mean 'tcpin'"],
    ),
    "port of a URL": (
        ("tcpin:127.0.0.1:0", "tcpin:127.0.0.1:99999"),
        ["links.ground.links", "the port is 99999, allowed 0 to 65535"],
    ),
    "choice": (
        ('"return"', '"retur"'),
        ["links.ground.failsafe", "did you mean 'return'"],
    ),
    "text": (('failsafe = "return"', "failsafe = 3"), ["links.ground.failsafe", "text", "found 3"]),
    "time of a link": (('"10 s"', '"10 m"'), ["links.ground.station_timeout", "'m'", "'s'"]),
    "link no table": (("[links.ground]", "[links]\nx = 3\n[links.y]"), ["links.x.kind"]),
    "table twice": (("[home]", "[[home]]"), ["home", "dictionary"]),
    "not TOML": (('title = "A boat"', "title = A boat"), ["not TOML", "line 1"]),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake_names_file_key_and_remedy(mistake, load):
    (old, new), expected = MISTAKES[mistake]
    with pytest.raises(InputError) as caught:
        load(old, new)
    message = str(caught.value)
    for text in ["boat.toml", *expected]:
        assert text in message


def test_a_link_of_a_kit_that_is_not_here_hinders_who_asks_for_it_alone(write):
    path = write("boat.toml", GOOD.replace('"mavlink"', '"sonar-of-ours"'))
    profile = load_profile(str(path))
    assert profile.parameters("sensors.gnss")
    assert "links.ground" not in profile.sections()
    for ask in (
        profile.parameters,
        lambda section: Profiles(str(path), path.parent).find(section, "x"),
    ):
        with pytest.raises(
            InputError, match=r"links\.ground\.kind: unknown kind of link 'sonar-of-ours'"
        ):
            ask("links.ground")


def test_every_mistake_is_reported(load):
    with pytest.raises(InputError) as caught:
        load('altitude = "120 cm"\ndate = 2026-02-05', 'altitude = "120 kg"\ndate = 3')
    assert len(str(caught.value).splitlines()) == 2


def test_mistakes_of_all_kinds_are_reported_together(write):
    text = GOOD
    for old, new in [
        ('kind = "compass"', 'kind = "compas"'),
        ("[sensors.gnss]", '[sensors.other]\nkind = "gps"\n[sensors.gnss]'),
        ("dropout = 0.01", "dropout = 2"),
        ("system_id = 7", "system_id = 0"),
    ]:
        text = text.replace(old, new)
    path = write("boat.toml", text)
    with pytest.raises(InputError) as caught:
        check_profile(str(path))
    keys = [line.removeprefix(f"{path}: ") for line in str(caught.value).splitlines()]
    assert sorted(key.partition(": ")[0] for key in keys) == [
        "identity.system_id",
        "sensors.gnss.dropout",
        "sensors.heading.kind",
        "sensors.other.kind",
    ]


def test_every_clash_of_channels_is_reported(load):
    with pytest.raises(InputError) as caught:
        load(
            'channel = 2\nport = "rudder.pulse"\npulse_min = "1000 us"',
            'channel = 1\nport = "port_thruster.pulse"\npulse_min = "1600 us"',
        )
    assert [line.split(": ")[1] for line in str(caught.value).splitlines()] == [
        "actuators.rudder",
        "actuators.rudder.channel",
        "actuators.rudder.port",
    ]


def test_file_that_is_not_there():
    with pytest.raises(InputError, match="no file"):
        load_profile("nowhere.toml")
    with pytest.raises(InputError, match="did you mean 'hydrone'"):
        load_profile("hydron")


# ------------------------------------------------------------------ shipped


SHIPPED = sorted(
    path for folder in provided_folders("hil_profiles") for path in folder.glob("*.toml")
)


@needs_kits(*OF_PROFILES)
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_profile_fits_its_components(path):
    profile = check_profile(str(path))
    for section in profile.sections():
        group, _, name = section.partition(".")
        if group == "actuators":
            classes = [Thruster, Servo]
        else:
            classes = [component_class(profile.tables(group)[name]["kind"])]
        for cls in classes:
            component = cls(name)
            for parameter, value in profile.parameters(section).items():
                component.set(parameter, value)
            component.check_parameters()


def test_hydrone_is_shipped():
    assert load_profile("hydrone").sections()[:2] == ["actuators.port", "actuators.starboard"]


def test_sections_are_found_in_the_rigs_profile_or_in_the_one_they_name(write):
    profiles = Profiles("hydrone", write("rig.toml", "").parent)
    own, section = profiles.find("sensors.gnss", "here")
    assert (own.read_from.name, section) == ("hydrone", "sensors.gnss")
    other, section = profiles.find("bluerov2:sensors.depth", "here")
    assert (other.read_from.name, section) == ("bluerov2", "sensors.depth")
    with pytest.raises(InputError, match="here: the rig names no profile"):
        Profiles(None, write("rig.toml", "").parent).find("sensors.gnss", "here")


@needs_kits("nmea")
def test_a_link_that_may_lack_is_one_of_its_kind_with_what_the_rest_of_the_profile_says(write):
    write("rig.toml", "")
    profiles = Profiles("hydrone", write("rig.toml", "").parent)
    profile, section = profiles.find("links.nmea0183?", "here")
    assert section == "links.nmea0183"
    given = profile.parameters(section)
    assert math.degrees(given["latitude"]) == pytest.approx(-31.7806, abs=0.1)
    assert "sentences" not in given
    with pytest.raises(InputError, match=r"here: .*'links.nmea0184'.*'links\.nmea0183'"):
        profiles.find("links.nmea0184?", "here")
