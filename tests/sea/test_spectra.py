"""Spectra against values and moments computed elsewhere, and closed forms."""

import math

import numpy as np
import pytest
from scipy.special import gamma as gamma_function

from seatrial.errors import InputError
from seatrial.physics.sea.spectra import (
    Bretschneider,
    Jonswap,
    Tma,
    Torsethaugen,
    band_energies,
    jonswap_normalisation,
    moment,
    pierson_moskowitz_of_height,
    pierson_moskowitz_of_wind,
    statistics,
)

from .references import content, table

SPECTRA = {
    "pm_u10": pierson_moskowitz_of_wind(10.0),
    "bret_05_4": Bretschneider(0.5, 4.0),
    "jon_05_4_33": Jonswap(0.5, 4.0, 3.3),
    "jon_25_8_5": Jonswap(2.5, 8.0, 5.0),
    "tors_25_8": Torsethaugen(2.5, 8.0),
    "tors_2_14": Torsethaugen(2.0, 14.0),
    "tma_1_6_33_h5": Tma(1.0, 6.0, 5.0, 3.3),
}

# gamma: A exact, Tz/Tp, T1/Tp, Te/Tp, Omega/wp
SHAPES = {
    1.0: (1.0, 0.71037, 0.77177, 0.85722, 1.10982),
    2.0: (0.802810, 0.74645, 0.80630, 0.88354, 0.85416),
    3.3: (0.655760, 0.77741, 0.83433, 0.90330, 0.65940),
    5.0: (0.538090, 0.80529, 0.85834, 0.91919, 0.52271),
    7.0: (0.449404, 0.82851, 0.87748, 0.93123, 0.43420),
}


@pytest.mark.parametrize("name", SPECTRA)
def test_densities_and_moments_are_those_of_the_reference(name):
    data, expected = table("spectra"), content("spectra")[name]
    spectrum, reference = SPECTRA[name], data[name]
    # The reference's moment of the TMA spectrum, which normalises it, is 5.2e-8 high.
    rtol = 6e-8 if name.startswith("tma") else 1e-8
    np.testing.assert_allclose(spectrum.density(data["omega"]), reference, rtol=rtol, atol=1e-300)
    found = {f"m{n}": moment(spectrum, n, 0.02, 2000.0) for n in (0, 1, 2)}
    found["m_minus1"] = moment(spectrum, -1, 0.02, 2000.0)
    found["m4_to_10"] = moment(spectrum, 4, 0.02, 10.0)
    given = statistics(spectrum, 0.02, 2000.0)
    found |= {
        "Hm0": given.height,
        "T1": given.mean_period,
        "Tz": given.zero_crossing_period,
        "Te": given.energy_period,
    }
    assert found == pytest.approx({key: expected[key] for key in found}, rel=1e-6)


@pytest.mark.parametrize("gamma", SHAPES)
def test_shape_of_jonswap_depends_on_gamma_alone(gamma):
    scale, *periods, width = SHAPES[gamma]
    found = statistics(Jonswap(0.7, 5.0, gamma), 0.05, 1e4)
    assert jonswap_normalisation(gamma) == pytest.approx(scale, abs=6e-7)
    assert found.height == pytest.approx(0.7, rel=1e-9)
    ratios = [found.zero_crossing_period, found.mean_period, found.energy_period]
    # The published periods are of tails cut somewhat above 100 wp: Tz is 2e-5 longer there.
    assert np.array(ratios) / 5.0 == pytest.approx(periods, abs=2e-5)
    assert found.width * 5.0 / math.tau == pytest.approx(width, abs=6e-6)


def test_jonswap_without_enhancement_is_bretschneider():
    omega = np.geomspace(0.3, 30.0, 200)
    plain = Bretschneider(0.5, 4.0).density(omega)
    np.testing.assert_allclose(Jonswap(0.5, 4.0, 1.0).density(omega), plain, rtol=1e-15)


def test_moments_of_bretschneider_have_a_closed_form():
    wp, level = math.tau / 4.0, 5.0 / 16.0 * 0.5**2 * (math.tau / 4.0) ** 4
    for n in (-1, 0, 1, 2, 3):
        closed = level / 4.0 * (1.25 * wp**4) ** (n / 4 - 1) * gamma_function(1 - n / 4)
        tail = level * 1e4 ** (n - 4) / (4 - n)
        found = moment(Bretschneider(0.5, 4.0), n, 0.01, 1e4)
        assert found == pytest.approx(closed - tail, rel=1e-11)


def test_fully_developed_sea_by_wind_and_by_height():
    by_wind = pierson_moskowitz_of_wind(12.0)
    assert by_wind.height == pytest.approx(0.209246 * 144.0 / 9.81, rel=1e-5)
    assert math.tau / by_wind.period == pytest.approx(0.877163 * 9.81 / 12.0, rel=1e-6)
    by_height = pierson_moskowitz_of_height(by_wind.height)
    assert by_height.period == pytest.approx(by_wind.period, rel=1e-14)


def test_parts_of_torsethaugen():
    for name in ("tors_25_8", "tors_2_14"):
        (h1, t1, gamma1), (h2, t2, gamma2) = SPECTRA[name].parts
        expected = content("spectra")[name]["parts_H1_T1_gamma1_H2_T2"]
        assert [h1, t1, gamma1, h2, t2] == pytest.approx(expected, rel=1e-13)
        assert gamma2 == 1.0
    assert Torsethaugen(2.5, 8.0).outside() is None
    assert "0.3 m and 4 s" in Torsethaugen(0.3, 4.0).outside()
    at_the_limit = Torsethaugen(2.0, 6.6 * 2.0 ** (1 / 3))
    assert at_the_limit.density(np.array([0.8])) > 0.0


def test_shallow_water_lowers_the_waves_unless_their_height_is_kept():
    free = Tma(1.0, 6.0, 5.0, keep_height=False)
    assert statistics(free, 0.02, 1e3).height < 0.8
    omega = np.array([0.9, 1.3, 4.0])
    kept = Tma(1.0, 6.0, 5.0).density(omega)
    assert np.ptp(kept / free.density(omega)) < 1e-15 * kept[0] * 100
    np.testing.assert_allclose(
        Tma(1.0, 6.0, 1e4).density(omega), Jonswap(1.0, 6.0).density(omega), rtol=1e-9
    )


def test_energies_of_bands_add_up_whatever_the_bands():
    jonswap = Jonswap(0.5, 4.0)
    whole = moment(jonswap, 0, 0.8, 12.0)
    for count in (1, 7, 80):
        energies = band_energies(jonswap, np.geomspace(0.8, 12.0, count + 1))
        assert energies.sum() == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: Bretschneider(0.0, 4.0), "height"),
        (lambda: Jonswap(1.0, -1.0), "period"),
        (lambda: Jonswap(1.0, 4.0, 0.5), "gamma"),
        (lambda: Torsethaugen(math.nan, 4.0), "height"),
        (lambda: Tma(1.0, 4.0, 0.0), "depth"),
        (lambda: pierson_moskowitz_of_wind(-3.0), "speed"),
    ],
)
def test_impossible_numbers_are_named(make, named):
    with pytest.raises(InputError, match=named):
        make()


@pytest.mark.parametrize(
    ("height", "period", "inside"),
    [
        *((0.5, 4.0, True), (11.0, 18.9, True), (5.0, 19.0, True), (5.0, 19.1, False)),
        *((0.49, 4.0, False), (11.1, 15.0, False), (0.6, 3.5, True), (0.6, 3.4, False)),
    ],
)
def test_torsethaugen_says_where_it_was_fitted(height, period, inside):
    assert (Torsethaugen(height, period).outside() is None) == inside
