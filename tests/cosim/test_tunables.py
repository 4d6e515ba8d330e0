"""Tunables of a profile's link: what is read, what is refused, what the link takes."""

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.profile.profile import check_profile
from seatrial.system.tunables import Tunable, carried
from seatrial_kits.mavlink.component import Mavlink
from tests.cosim.test_profile import GOOD
from tests.kit import needs_kits

TABLE = """
[links.ground.tunables]
CRUISE_SPEED = { sets = "guidance.cruise_speed", min = 0, max = 1.5 }
RUDDER_MAX   = { sets = ["autopilot.rudder_limit", "helm.rudder_limit"], unit = "deg", min = 1, max = 35 }
"""


@pytest.fixture
def load(write):
    """Return a function that reads a profile with a table, one text replaced by another."""

    def load(old="", new="", more=""):
        assert not old or TABLE.count(old) == 1
        return check_profile(
            "boat.toml", write("boat.toml", GOOD + TABLE.replace(old, new) + more).parent
        )

    return load


def test_a_table_gives_them_in_its_order(load):
    profile = load()
    assert profile.tunables("links.ground") == (
        Tunable("CRUISE_SPEED", ("guidance.cruise_speed",), 0.0, 1.5, ""),
        Tunable("RUDDER_MAX", ("autopilot.rudder_limit", "helm.rudder_limit"), 1.0, 35.0, "deg"),
    )
    # They are no values of the link: they start with what they set.
    assert "tunables" not in profile.parameters("links.ground")
    assert profile.tunables("sensors.gnss") == profile.tunables("actuators.port") == ()


def test_the_link_takes_them_as_a_text(load):
    text = carried(load().tunables("links.ground"), [1.0, 12.5])
    assert text == "CRUISE_SPEED 1.0 0.0 1.5; RUDDER_MAX 12.5 1.0 35.0"
    link = Mavlink("link")
    for name, value in {"links": "udpin:127.0.0.1:0", "tunables": text}.items():
        link.set(name, value)
    link.initialise()
    assert link.get("tunable")[:3] == [1.0, 12.5, 0.0]
    link.close()


PLACE = "links.ground.tunables"


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        (", max = 1.5", "", [f"{PLACE}.CRUISE_SPEED.max: this key is missing"]),
        ("max = 1.5", "most = 1.5, max = 2", [f"{PLACE}.CRUISE_SPEED.most", "unknown key"]),
        ("max = 1.5", "maxx = 1.5, max = 2", ["did you mean 'max'"]),
        ("max = 1.5", 'max = "1.5 m/s"', [f"{PLACE}.CRUISE_SPEED.max", "found '1.5 m/s'"]),
        ("max = 1.5", "max = true", [f"{PLACE}.CRUISE_SPEED.max", "found True"]),
        ("max = 1.5", "max = -1", [f"{PLACE}: CRUISE_SPEED: ", "0 is above its high limit -1"]),
        ("max = 1.5", "max = inf", [f"{PLACE}: CRUISE_SPEED: ", "'inf' is no number"]),
        ("CRUISE_SPEED", "A23456789_1234567", ["A23456789_1234567", "1 to 16 capital letters"]),
        ("CRUISE_SPEED", "cruise", [f"{PLACE}: cruise: ", "1 to 16 capital letters"]),
        ("CRUISE_SPEED", '"A 1 0 2; B"', [f"{PLACE}: 'A 1 0 2; B' cannot be a tunable's name"]),
        ('"deg"', '"degz"', [f"{PLACE}: RUDDER_MAX: ", "degz"]),
        ('"guidance.cruise_speed"', '"cruise_speed"', ["CRUISE_SPEED.sets", "'cruise_speed'"]),
        ('"guidance.cruise_speed"', "[]", ["CRUISE_SPEED.sets: at least one"]),
        ('"guidance.cruise_speed"', "3", [f"{PLACE}.CRUISE_SPEED.sets", "found 3"]),
        (
            '"guidance.cruise_speed"',
            '"helm.rudder_limit"',
            ["RUDDER_MAX.sets: 'helm.rudder_limit' is already set by CRUISE_SPEED"],
        ),
    ],
)
def test_a_mistake_names_file_and_place(load, old, new, found):
    with pytest.raises(InputError) as caught:
        load(old, new)
    for text in ("boat.toml: ", *found):
        assert text in str(caught.value)


def test_a_text_is_no_table(write):
    text = GOOD.replace('failsafe = "return"', 'tunables = "STEER_P 9 0 50"')
    with pytest.raises(
        InputError, match=r"links\.ground\.tunables: a table with an entry for each"
    ):
        check_profile("boat.toml", write("boat.toml", text).parent)


def test_there_are_as_many_as_the_link_has_outputs(load):
    def more(count):
        return "".join(f'T{n} = {{ sets = "a.t{n}", min = 0, max = 1 }}\n' for n in range(count))

    assert len(load(more=more(62)).tunables("links.ground")) == len(Mavlink.ports["tunable"].axes)
    with pytest.raises(InputError, match=f"{PLACE}: 65 tunables, at most 64 are allowed"):
        load(more=more(63))


def test_all_mistakes_are_reported(load):
    with pytest.raises(InputError) as caught:
        load("max = 1.5", "max = -1", more='b = { sets = "a.b", min = 0, max = 1 }\n')
    assert len(str(caught.value).splitlines()) == 2


RIG_OF_A_PILOT = """
step = "10 ms"
profile = "wide.toml"
[components]
mavlink = { fmu = "mavlink", profile = "links.ground", set = { links = "udpin:127.0.0.1:0" } }
pilot = { rig = "pilots/bluerov2" }
[connections]
"mavlink.orders" = "pilot.orders"
"""


@needs_kits("mavlink", "ships")
def test_a_value_of_the_vehicle_s_file_stays_where_its_tunable_starts():
    """What something else is set later must not bring back the start value of the component."""
    rig = load_rig("sil", choices={"vehicle": "mariner", "autopilot": "mavlink"})
    system = assemble(rig, "direct")
    link, gain = system.parts["autopilot.mavlink"], ("autopilot.pilot.autopilot", "derivative_gain")
    given = system.parts[gain[0]].given[gain[1]].value
    assert given != system.parts[gain[0]].instance.variables[gain[1]].start
    system.set("autopilot.pilot.guidance.lookahead", "900 m", "test")
    assert f"HDG_D {given!r} " in link.given[system.tunings[0].text].value
    assert gain in system.tuned
    system.free()


def test_limits_beyond_those_of_what_it_sets_are_refused(tmp_path):
    """In the unit of the tunable: cm/s, of a speed that must not be below 0."""
    text = (Path(__file__).parents[2] / "hil_profiles/bluerov2.toml").read_text()
    wide = text.replace(
        'guidance.surface_depth", unit = "cm", min = 0',
        'guidance.surface_depth", unit = "cm", min = -1',
    )
    assert wide != text
    (tmp_path / "wide.toml").write_text(wide)
    (tmp_path / "rig.toml").write_text(RIG_OF_A_PILOT)
    with pytest.raises(InputError, match=r"SURFACE_DEPTH: -1\.0 cm is beyond the limit .*, 0\.0 m"):
        assemble(load_rig(str(tmp_path / "rig.toml")), "direct")


def test_every_shipped_profile_is_here():
    shipped = {path.stem for path in (Path(__file__).parents[2] / "hil_profiles").glob("*.toml")}
    assert shipped == {
        *("hydrone", "otter", "bluerov2"),
    }
