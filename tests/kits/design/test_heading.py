"""Root loci of the Mariner against independently computed eigenvalues and Routh's criterion.

Figures of [Moro1979] are those of its figures 6 to 8 and section 4.
"""

import csv
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.design.heading import closed_loop, design_heading, least_damping
from seatrial_kits.design.heading_page import stability, write_design

DATA = Path(__file__).parents[2] / "reference"
A = np.array([[-0.76944, -0.33442], [-3.38925, -2.09400]])
B = np.array([4.3247, -41.235])
TIMES = (0.0, -1.3427, 1.25379)


@pytest.fixture(scope="module")
def loci():
    design = design_heading("mariner", "source", TIMES)
    return {locus.derivative_time: locus for locus in design.loci}


@cache
def designed(derivative_time):
    return design_heading("mariner", "source", [derivative_time])


def rows():
    with (DATA / "mariner_eigenvalues.csv").open() as file:
        return [{k: float(v or "nan") for k, v in row.items()} for row in csv.DictReader(file)]


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row['Td']:g}-{row['K']:g}")
def test_eigenvalues(row):
    design = designed(row["Td"])
    poles = np.linalg.eigvals(closed_loop(design.A, design.B, row["K"], row["Td"]))
    expected = [row[f"re{i}"] + 1j * row[f"im{i}"] for i in (1, 2, 3)]
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(expected), atol=1e-8)
    if row["K"]:
        assert least_damping(poles) == pytest.approx(row["zeta_min"], abs=1e-8)
        assert (poles.real.max() < 0) == bool(row["stable"])


def test_matrices_are_those_of_the_source():
    design = design_heading("mariner", "source")
    np.testing.assert_allclose(design.A, A, rtol=1e-13)
    np.testing.assert_allclose(design.B, B, rtol=1e-13)
    assert design.time_unit == pytest.approx(20.852608)
    assert [locus.derivative_time for locus in design.loci] == pytest.approx([0, 1.25379])


def test_gains_for_a_damping_ratio_of_0_7071(loci):
    found = {T_d: [gain.K for gain in locus.wanted] for T_d, locus in loci.items()}
    # 8 significant digits
    assert found[0.0] == pytest.approx([0.0010153384], rel=5e-8)
    assert found[-1.3427] == pytest.approx([0.00081096277], rel=5e-8)
    assert found[1.25379] == pytest.approx([0.0013918792, 0.033277375], rel=5e-8)
    pairs = {
        T_d: [max(gain.poles, key=lambda pole: pole.imag) for gain in locus.wanted]
        for T_d, locus in loci.items()
    }
    expected = {0.0: [0.093811], -1.3427: [0.084246], 1.25379: [0.108993, 0.458816]}
    for T_d, sizes in expected.items():
        np.testing.assert_allclose(pairs[T_d], [s * (-1 + 1j) for s in sizes], atol=1e-6)


def test_gain_of_the_source_has_nearly_the_damping_it_says():
    poles = np.linalg.eigvals(closed_loop(A, B, 0.034, 1.25379))
    expected = [-3.692280, -0.464480 - 0.459775j, -0.464480 + 0.459775j]
    np.testing.assert_allclose(np.sort_complex(poles), expected, atol=1e-6)
    assert least_damping(poles) == pytest.approx(0.7106977, abs=1e-7)
    assert least_damping(np.linalg.eigvals(closed_loop(A, B, 0.034, 1.2386462))) == pytest.approx(
        np.sqrt(0.5), abs=1e-7
    )


def test_limit_of_stability_is_routh_s(loci):
    (limit,) = loci[-1.3427].limits
    assert pytest.approx(0.0114200518, abs=1e-9) == limit.K
    K, KT = limit.K, limit.K * -1.3427
    # s^3 + a2 s^2 + a1 s + a0 has a pair on the axis where a2 a1 = a0, at w^2 = a1.
    a2 = 2.86344 + 41.235 * KT
    a1 = 0.477774375 + 41.235 * K + 46.385347875 * KT
    a0 = 46.385347875 * K
    assert a2 * a1 == pytest.approx(a0, abs=1e-12)
    w = max(limit.poles.imag)
    assert w == pytest.approx(0.487259, abs=1e-6)
    assert w**2 == pytest.approx(a1, rel=1e-10)


def test_characteristic_polynomial():
    found = np.poly(closed_loop(A, B, 0.034, 1.25379))
    np.testing.assert_allclose(found, [1, 4.62124104, 3.85711888, 1.57710183], atol=5e-9)


@pytest.mark.parametrize(
    ("T_d", "text"),
    [
        (0.0, "every K up to 100"),
        (-1.3427, "K < 0.0114200518"),
        (1.25379, "every K up to 100"),
    ],
)
def test_claims_of_stability(loci, T_d, text):
    assert stability(loci[T_d]) == text


def test_least_damping_with_positive_derivative_time(loci):
    values = [least_damping(poles) for poles in loci[1.25379].poles]
    assert min(values) == pytest.approx(0.54971, abs=1e-5)


def test_no_eigenvalue_tends_to_the_origin_with_a_negative_derivative_time():
    """The source states it of its figure 7; they leave the origin, where they are at K = 0."""
    poles = np.sort(np.linalg.eigvals(closed_loop(A, B, 1e6, -1.3427)).real)
    np.testing.assert_allclose(poles[:2], [-1.1249, 1 / 1.3427], atol=1e-4)
    assert poles[2] > 1e6


def test_gains_scale_with_the_rudder_s_effect():
    printed, corrected = (
        design_heading("mariner", variant, [1.25379]).loci[0].wanted
        for variant in ("source", "linear")
    )
    for a, b in zip(printed, corrected, strict=True):
        assert pytest.approx(25.3171479, rel=1e-9) == b.K / a.K


def test_page(tmp_path):
    page = write_design(design_heading("mariner", "cubic"), tmp_path / "out").read_text("utf-8")
    assert "Heading autopilot of mariner, variant cubic" in page
    assert "stable for every K up to 100" in page
    with pytest.raises(InputError, match="not an empty folder"):
        write_design(design_heading("mariner"), tmp_path / "out")


@pytest.mark.parametrize(
    ("name", "options", "reason"),
    [
        ("hydrone", {}, "a vehicle with a table 'manoeuvring-ship' is needed"),
        ("mariner", {"variant": "cubed"}, "cubic"),
        ("mariner", {"damping_ratio": 1.0}, "between 0 and 1"),
    ],
)
def test_bad_input(name, options, reason):
    with pytest.raises(InputError, match=reason):
        design_heading(name, **options)
