"""Faults of single measured outputs of a sensor, against their definitions."""

import math

import numpy as np
import pytest

from seatrial.devices.compass import Compass
from seatrial.devices.gnss import Gnss
from seatrial.errors import InputError
from seatrial.model.faults.text import MEASURED, fault_text, read_text

from .running import started

IDEAL = {"delay": 0.0, "period": 0.1, "position_n_noise": 0, "position_n_instability": 0}
IDEAL |= {"position_n_resolution": 0}
X = (3.0, -4.0, -1.0)
TEXTS = {
    "bias": ("value=1.0,2.0,3.0", lambda t, s: [3 + s, -4 + 2 * s, -1 + 3 * s]),
    "drift": ("rate=0.5,0.0,-0.5", lambda t, s: [3 + 0.5 * t, -4, -1 - 0.5 * t]),
    "scale": ("factor=0.5", lambda t, s: [x * (1 - 0.5 * s) for x in X]),
}


def measured(text: str, steps: int = 30) -> np.ndarray:
    """Return positions at 0, 0.1 s and so on."""
    gnss = started(Gnss, **IDEAL)
    gnss.set("fault", text)
    for axis, value in zip("xyz", X, strict=True):
        gnss.set(f"position.{axis}", value)
    gnss.refresh()
    found = [list(gnss.position_n)]
    for k in range(steps):
        gnss.advance(k * 0.1, 0.1)
        found.append(list(gnss.position_n))
    return np.array(found)


@pytest.mark.parametrize("what", TEXTS)
@pytest.mark.parametrize("grows", ["", " grows_over=1.0"])
def test_each_measurement_is_what_the_definition_says(what: str, grows: str) -> None:
    settings, expected = TEXTS[what]
    found = measured(f"{what} of=position_n {settings} at=0.0{grows}")
    shares = [min(1.0, 0.1 * k) if grows else 1.0 for k in range(31)]
    truth = [expected(0.1 * k, s) for k, s in enumerate(shares)]
    assert found == pytest.approx(np.array(truth), abs=1e-12)


def test_noise_is_of_its_own_and_the_others_numbers_stay() -> None:
    plain = measured("none")
    noisy = measured("noise of=position_n value=2.0,0.0,0.0 at=0.0", 3000)
    assert abs(noisy[:, 0].std() - 2.0) < 3.9 * 2.0 / math.sqrt(6000)
    assert abs(noisy[:, 0].mean() - 3.0) < 3.9 * 2.0 / math.sqrt(3000)
    assert (noisy[:31, 1:] == plain[:, 1:]).all()


def test_a_compass_beside_iron_deviates_and_stays_on_its_card() -> None:
    settings = {"period": 0.1, "deviation": [0, 0, 0, 0], "heading_noise": 0}
    settings |= {"heading_instability": 0, "heading_resolution": 0}
    coefficients = (0.05, 0.1, -0.2, 0.03, 0.04)
    text = fault_text("deviation", "heading", {"coefficients": coefficients}, 0.0)
    for psi in np.linspace(-3.1, 3.1, 41).tolist():
        compass = started(Compass, **settings)
        compass.set("attitude.psi", psi)
        compass.set("fault", text)
        compass.refresh()
        a, b, c, d, e = coefficients
        shown = psi + a + b * math.sin(psi) + c * math.cos(psi)
        shown += d * math.sin(2 * psi) + e * math.cos(2 * psi)
        assert compass.heading == pytest.approx(shown % math.tau, abs=1e-12)


def test_texts_are_read_as_they_were_written() -> None:
    text = fault_text("bias", "position_n", {"value": [1.0, 2.5e-7, -3.0]}, 12.5, 4.0)
    found = read_text(text)
    assert (found.what, found.of, found.at, found.grows_over) == ("bias", "position_n", 12.5, 4.0)
    assert found.settings["value"] == (1.0, 2.5e-7, -3.0)
    assert set(MEASURED) == {"bias", "drift", "scale", "noise", "deviation"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bias", "unknown fault 'bias'"),
        ("bias of=position_n", "bias needs of, value"),
        ("bias value=1", "bias needs of, value"),
        ("bias of=position_n value=x", "is no fault such as"),
        ("bias of=position_n value=nan", "is no fault such as"),
        ("bias of=positon value=1", "unknown measured output 'positon'"),
        ("off of=position_n", "unknown fault of a measurement 'off'"),
    ],
)
def test_a_text_that_is_none_is_refused(text: str, message: str) -> None:
    gnss = started(Gnss, delay=0.0)
    gnss.set("fault", text)
    with pytest.raises(InputError, match=message):
        gnss.refresh()
