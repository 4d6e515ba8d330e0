"""Waves, current and wind around hulls: C against its equal in Python, bit by bit."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from seatrial.physics.craft.around import SIZE, Around, Places, WavesAtParts
from seatrial.physics.sea.currents import CurrentState
from seatrial.physics.sea.loads import WaveLoads
from seatrial.physics.sea.orbital import Orbital
from seatrial.physics.sea.seastate import SeaState
from seatrial.physics.sea.wind_loads import Areas, Blendermann, Isherwood, Ship, Silhouette
from seatrial.physics.sea.winds import WindState
from seatrial_kits.native.surroundings import MET
from seatrial_kits.native.weather import WeatherInC, weather_at

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux")

IN_SPACE = Places(x=0, y=1, z=2, psi=5, u=6, v=7)
AT_SURFACE = Places(x=1, y=0, z=None, psi=2, u=3, v=4)
CROSSING = SeaState(
    "jonswap",
    0.4,
    3.0,
    direction=2.0,
    spreading=6.0,
    swell_height=(0.2, 0.0, 0.0),
    swell_period=(6.0, 0.0, 0.0),
    swell_direction=(-1.0, 0.0, 0.0),
    swell_gamma=(7.0, 7.0, 7.0),
    swell_spreading=(0.0, 0.0, 0.0),
)
SHALLOW = SeaState("tma", 0.3, 3.5, direction=-0.4, depth=6.0)
REGULAR = SeaState("regular", 0.3, 4.0)
"""To the north: sines of its direction are 0, of either sign."""
LAYERS: dict[str, Any] = {
    "profile": "layers",
    "layers": 3,
    "layer_depths": (1.0, 2.5, 6.0),
    "layer_speeds": (0.4, 0.0, 0.3),
    "layer_directions": (0.2, 0.0, -2.0),
}
SLOW: dict[str, Any] = {"variation": 0.3, "turning": 0.5, "variation_time": 9.0, "seed": 4}
TIDE: dict[str, Any] = {"tide": 0.5, "tide_minor": -0.2, "tide_period": 60.0, "tide_axis": 0.4}
CURRENTS = {
    "uniform": CurrentState(0.4, -1.2),
    "slow": CurrentState(0.2, 2.0, **SLOW),
    "power and tide": CurrentState(0.4, 0.3, "power", reach=5.0, **TIDE),
    "linear and slow": CurrentState(0.4, 0.3, "linear", reach=5.0, **SLOW),
    "layers": CurrentState(0.3, 0.1, **LAYERS),
    "layers, slow, tide": CurrentState(0.3, 0.1, **LAYERS, **SLOW, **TIDE),
}
SHAPE = Silhouette(40.0, 60.0, 250.0)
WINDS = {
    "areas": (WindState(8.0, 0.5, "power", "norsok"), Areas(3.0, 8.0, 0.7, 1.3, 0.75, 0.9)),
    "isherwood": (
        WindState(9.0, 2.0, "froya", "harris", gust=6.0, gust_start=20.0, gust_duration=30.0),
        Ship(SHAPE, Isherwood(SHAPE, 9.0, 60.0, 19.0, 2, 80.0)),
    ),
    "blendermann": (
        WindState(gust=7.0, gust_start=0.0, gust_duration=100.0),
        Ship(SHAPE, Blendermann(SHAPE, "ferry", 1.5, 4.0)),
    ),
}


def response(omega, k, chi):
    """Return six loads per metre that depend on all that they can."""
    return np.exp(1j * np.outer(np.arange(1.0, 7.0), chi + k)) * (100.0 + 7.0 * omega)


def drift(omega, chi):
    return np.stack([omega * np.cos(chi), 2 * omega * np.sin(chi), 3 + 0 * omega])


def loads(sea: SeaState, with_drift: bool) -> WaveLoads:
    return WaveLoads(sea.waves(), response, drift if with_drift else None)


def parts(sea: SeaState) -> WavesAtParts:
    positions = np.random.default_rng(7).uniform(-3, 3, (3, 3))
    return WavesAtParts(Orbital(sea.waves()), (0, 1, 9), positions, 16)


AROUNDS = {
    "loads": Around(AT_SURFACE, loads(CROSSING, False)),
    "loads of one wave": Around(AT_SURFACE, loads(REGULAR, False)),
    "loads and drift": Around(IN_SPACE, loads(SHALLOW, True)),
    "orbital": Around(IN_SPACE, orbital=Orbital(CROSSING.waves())),
    "orbital of one wave": Around(IN_SPACE, orbital=Orbital(REGULAR.waves())),
    "shallow": Around(IN_SPACE, orbital=Orbital(SHALLOW.waves())),
    "parts": Around(IN_SPACE, loads(CROSSING, False), parts=parts(CROSSING)),
    "parts that are carried": Around(
        IN_SPACE, orbital=Orbital(SHALLOW.waves()), parts=parts(SHALLOW)
    ),
    "parts in a current": Around(
        IN_SPACE, current=CURRENTS["slow"], parts=WavesAtParts(None, (0,), np.ones((1, 3)), 16)
    ),
    **{name: Around(IN_SPACE, current=current) for name, current in CURRENTS.items()},
    **{name: Around(AT_SURFACE, wind=(*wind, 2.5)) for name, wind in WINDS.items()},
    "all": Around(
        IN_SPACE,
        orbital=Orbital(CROSSING.waves()),
        current=CURRENTS["layers, slow, tide"],
        wind=(*WINDS["areas"], 1.3),
    ),
}


class InC:
    """What C finds around a craft."""

    def __init__(self, around: Around) -> None:
        self.weather, self.size = WeatherInC(around), around.size
        self.function = MET(weather_at())

    def at(self, t: float, state: np.ndarray) -> np.ndarray | None:
        found = np.full(self.size + 1, 9.0)
        good = self.function(self.weather.address, t, state.ctypes.data, found.ctypes.data)
        assert found[-1] == 9.0
        return found[:-1] if good else None


def states(count: int) -> np.ndarray:
    """Return times and states of a craft, some above the water, some on whole headings."""
    draw = np.random.default_rng(3)
    found = draw.uniform(-1, 1, (count, 13)) * [90.0, 40, 40, 9, 2, 2, 9, *[9.0] * 6]
    found[:, 0] += 85.0  # some before the start, where one looks back from
    found[::5, 6] = np.arange(len(found[::5])) * np.pi / 90
    found[::7, 3] = 0.0
    return found


@pytest.mark.parametrize("name", AROUNDS)
def test_c_has_the_bits_of_python(name: str) -> None:
    around = AROUNDS[name]
    in_c, changes = InC(around), 0
    for t, *state in states(60):
        expected, found = around.at(t, np.array(state)), in_c.at(t, np.array(state))
        assert expected.tobytes() == found.tobytes(), (t, state, expected - found)
        changes += bool(expected.any())
    assert changes > 40


def test_c_has_its_size() -> None:
    assert InC(AROUNDS["orbital"]).size == SIZE
    assert InC(AROUNDS["parts"]).size == SIZE + 48


@pytest.mark.parametrize(
    ("name", "place"), [("loads", 2), ("orbital", 0), ("parts", 3), ("areas", 3), ("isherwood", 3)]
)
def test_there_is_no_value_at_an_infinite_place(name: str, place: int) -> None:
    state = np.zeros(12)
    state[place] = np.inf
    found = InC(AROUNDS[name]).at(1.0, state)
    assert found is None or not np.isfinite(found).all()


def test_threads_that_meet_one_weather_make_its_tables_once() -> None:
    """Slow samples and headings are made when one first needs them."""
    sea, current = loads(CROSSING, True), CurrentState(0.2, 2.0, **SLOW)
    around = Around(IN_SPACE, sea, current=current)
    in_c, asked = InC(around), states(200)

    def meet(_: int) -> list[bytes]:
        return [in_c.at(t, np.array(state)).tobytes() for t, *state in asked]

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(meet, range(4)))
    expected = [around.at(t, np.array(state)).tobytes() for t, *state in asked]
    assert found == [expected] * 4


def test_samples_of_a_slow_variation_go_on_from_block_to_block() -> None:
    around = Around(IN_SPACE, current=CurrentState(0.2, 2.0, **SLOW))
    in_c, state = InC(around), np.zeros(12)
    for t in (62.5, 63.5, 64.5, 191.5, 192.5, 2000.25):
        assert in_c.at(t, state).tobytes() == around.at(t, state).tobytes()


def test_a_table_that_cannot_be_made_is_no_value(capfd: pytest.CaptureFixture[str]) -> None:
    def refuse(omega, k, chi):
        raise ValueError("no such heading")

    in_c = InC(Around(IN_SPACE, WaveLoads(REGULAR.waves(), refuse)))
    assert in_c.at(0.0, np.zeros(12)) is None
    assert "no such heading" in capfd.readouterr().err
