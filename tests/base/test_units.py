"""Units against the SI brochure and NIST SP 811; quantities against exact arithmetic."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.model.units import Unit, conversion, defined_unit, quantity, unit

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
FORCE, ENERGY = {"kg": 1, "m": 1, "s": -2}, {"kg": 1, "m": 2, "s": -2}
PRESSURE, POWER = {"kg": 1, "m": -1, "s": -2}, {"kg": 1, "m": 2, "s": -3}

# The SI brochure (9th edition), tables 2 to 8; NIST SP 811, appendix B.8, for the last block.
TABLE = [
    *[(name, "1", {name: 1}) for name in BASE],
    ("g", "0.001", {"kg": 1}),
    ("t", "1000", {"kg": 1}),
    ("sr", "1", {"rad": 2}),
    ("Hz", "1", {"s": -1}),
    ("N", "1", FORCE),
    ("Pa", "1", PRESSURE),
    ("J", "1", ENERGY),
    ("W", "1", POWER),
    ("C", "1", {"A": 1, "s": 1}),
    ("V", "1", {"kg": 1, "m": 2, "s": -3, "A": -1}),
    ("F", "1", {"kg": -1, "m": -2, "s": 4, "A": 2}),
    ("ohm", "1", {"kg": 1, "m": 2, "s": -3, "A": -2}),
    ("S", "1", {"kg": -1, "m": -2, "s": 3, "A": 2}),
    ("Wb", "1", {"kg": 1, "m": 2, "s": -2, "A": -1}),
    ("T", "1", {"kg": 1, "s": -2, "A": -1}),
    ("H", "1", {"kg": 1, "m": 2, "s": -2, "A": -2}),
    ("lm", "1", {"cd": 1, "rad": 2}),
    ("lx", "1", {"cd": 1, "rad": 2, "m": -2}),
    ("kat", "1", {"mol": 1, "s": -1}),
    ("min", "60", {"s": 1}),
    ("h", "3600", {"s": 1}),
    ("d", "86400", {"s": 1}),
    ("L", "0.001", {"m": 3}),
    ("l/min", str(Fraction(1, 60_000)), {"m": 3, "s": -1}),
    ("ha", "10000", {"m": 2}),
    ("eV", "1.602176634e-19", ENERGY),
    ("bar", "100000", PRESSURE),
    ("mbar", "100", PRESSURE),
    ("dbar", "10000", PRESSURE),
    ("hPa", "100", PRESSURE),
    ("km", "1000", {"m": 1}),
    ("MN", "1000000", FORCE),
    ("mN", "0.001", FORCE),
    ("us", "0.000001", {"s": 1}),
    ("µs", "0.000001", {"s": 1}),
    ("ns", "1e-9", {"s": 1}),
    ("uT", "1e-6", {"kg": 1, "s": -2, "A": -1}),
    ("mrad", "0.001", {"rad": 1}),
    ("%", "0.01", {}),
    ("ppm", "1e-6", {}),
    ("1", "1", {}),
    ("", "1", {}),
    ("nmi", "1852", {"m": 1}),
    ("kn", str(Fraction(1852, 3600)), {"m": 1, "s": -1}),
    ("knot", str(Fraction(1852, 3600)), {"m": 1, "s": -1}),
    ("inch", "0.0254", {"m": 1}),
    ("ft", "0.3048", {"m": 1}),
    ("lb", "0.45359237", {"kg": 1}),
    ("lbf", str(Fraction("0.45359237") * Fraction("9.80665")), FORCE),
    (
        "psi",
        str(Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254") ** 2),
        PRESSURE,
    ),
    ("atm", "101325", PRESSURE),
    ("hp", str(550 * Fraction("0.3048") * Fraction("0.45359237") * Fraction("9.80665")), POWER),
    ("metric_horsepower", "735.49875", POWER),
    ("Wh", "3600", ENERGY),
    ("kWh", "3.6e6", ENERGY),
    ("Ah", "3600", {"A": 1, "s": 1}),
    ("cP", "0.001", {"kg": 1, "m": -1, "s": -1}),
    ("cSt", "1e-6", {"m": 2, "s": -1}),
]


@pytest.mark.parametrize(("text", "factor", "exponents"), TABLE, ids=[t[0] for t in TABLE])
def test_factors_and_dimensions_of_the_si_brochure(text: str, factor: str, exponents) -> None:
    """The factor is the double nearest to the exact one, to the last bit."""
    measure = unit(text)
    assert (measure.factor, measure.offset) == (float(Fraction(factor)), 0.0)
    assert measure.exponents == exponents


PI = Fraction("3.14159265358979323846264338327950288419716939937510")


@pytest.mark.parametrize(
    ("text", "in_rad"),
    [
        ("deg", PI / 180),
        ("°", PI / 180),
        ("arcmin", PI / 10_800),
        ("arcsec", PI / 648_000),
        ("gon", PI / 200),
        ("rev", 2 * PI),
        ("turn", 2 * PI),
    ],
)
def test_angles(text: str, in_rad: Fraction) -> None:
    assert (unit(text).factor, unit(text).exponents) == (float(in_rad), {"rad": 1})


@pytest.mark.parametrize("text", ["rpm", "rev/min", "turn/min"])
def test_revolutions_per_minute(text: str) -> None:
    assert unit(text).factor == float(2 * PI / 60)
    assert unit(text).exponents == {"rad": 1, "s": -1}


@pytest.mark.parametrize(
    ("text", "factor", "exponents"),
    [
        ("N.m", 1, ENERGY),
        ("kg.m2", 1, {"kg": 1, "m": 2}),
        ("rad/s", 1, {"rad": 1, "s": -1}),
        ("m/s2", 1, {"m": 1, "s": -2}),
        ("m.s-2", 1, {"m": 1, "s": -2}),
        ("s-1", 1, {"s": -1}),
        ("1/s", 1, {"s": -1}),
        ("1/min", Fraction(1, 60), {"s": -1}),
        ("1/rad", 1, {"rad": -1}),
        ("N.s/m", 1, {"kg": 1, "s": -1}),
        ("N.s2/m2", 1, {"kg": 1, "m": -1}),
        ("N.m.s/rad", 1, {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("N.m.s2/rad2", 1, {"kg": 1, "m": 2, "rad": -2}),
        ("N.m/(rad/s)", 1, {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("kg/m3", 1, {"kg": 1, "m": -3}),
        ("kN.m", 1000, ENERGY),
        ("mm2", Fraction(1, 10**6), {"m": 2}),
        ("km/h", Fraction(10, 36), {"m": 1, "s": -1}),
        ("deg/s/s", PI / 180, {"rad": 1, "s": -2}),
        ("deg.s-1", PI / 180, {"rad": 1, "s": -1}),
        ("m2.kW", 1000, {"kg": 1, "m": 4, "s": -3}),
        ("V.s/Wb", 1, {}),
        ("kg·m²", 1, {"kg": 1, "m": 2}),
        ("kg*m**2", 1, {"kg": 1, "m": 2}),
        ("kg m^2", 1, {"kg": 1, "m": 2}),
    ],
)
def test_products_and_powers_as_fmi_writes_them(text: str, factor, exponents) -> None:
    assert unit(text).factor == float(Fraction(factor))
    assert unit(text).exponents == exponents


FACTORS = st.dictionaries(st.sampled_from(BASE), st.integers(-4, 4).filter(bool), max_size=8)


@given(FACTORS)
def test_any_product_of_base_units(exponents: dict[str, int]) -> None:
    text = ".".join(name if p == 1 else f"{name}{p}" for name, p in exponents.items())
    assert unit(text).exponents == exponents
    assert unit(text).factor == 1.0


@given(st.sampled_from([t for t, *_ in TABLE if t not in ("", "1", "%")]), st.sampled_from("+*/"))
def test_a_product_has_the_product_of_the_factors(text: str, operator: str) -> None:
    if operator == "+":
        with pytest.raises(InputError, match="is not a unit"):
            unit(f"{text}+{text}s")
        return
    whole = unit(f"{text}.kN" if operator == "*" else f"{text}/kN")
    sign = 1 if operator == "*" else -1
    assert whole.exact_factor == unit(text).exact_factor * Fraction(1000) ** sign
    for name in BASE:
        together = unit(text).exponents.get(name, 0) + sign * FORCE.get(name, 0)
        assert whole.exponents.get(name, 0) == together


def test_temperatures_have_an_offset() -> None:
    assert (unit("degC").factor, unit("degC").offset) == (1.0, 273.15)
    assert (unit("degF").factor, unit("degF").offset) == (5 / 9, float(Fraction("459.67") * 5 / 9))
    assert quantity("20 degC", "K") == 293.15
    assert quantity("-40 degF", "degC") == -40.0
    assert quantity("212 degF", "degC") == 100.0
    assert quantity("0 degC", "K") == 273.15
    assert conversion("K", "degC") == (1.0, -273.15)
    # A temperature in a product is a difference.
    assert (unit("W/degC").factor, unit("W/degC").offset) == (1.0, 0.0)


@pytest.mark.parametrize(
    "text",
    ["dBm", "dB", "dBW", "dBu", "Np", "octave", "decade", "dB/m", "dBm/Hz", "delta_decibel"],
)
def test_logarithmic_units_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="is not a unit"):
        unit(text)
    with pytest.raises(InputError, match="is not a unit"):
        quantity(f"3 {text}", "W")


@pytest.mark.parametrize(
    "text",
    [
        *("metres_", "kgg", "N.q", "2", "2 m", "0", "-1", "1.5", "nan", "inf", "m/0", "m**0", "[]"),
        *("m + s", "m+m", "m.", "N..m", ".m", "N. m", "m*", "/s", "1/", "m2/3", "sqrt(m)"),
        *("m;s", "m,s", "m=s", "m&s", "m:s", "s\nm", "m!", "m?s", "m#s", "m's", "m$"),
        # pint alone takes the e of these numbers for the elementary charge
        *("1e-3 m", "m*1e3", "1e3", "2.5e6*Pa"),
        # and these would take it for ever, or overflow
        *("99^99^99", "km^99^99", "km**(99**99)", "(km^99)^99", "km-99.km-99.km-99.km-99", "m100"),
    ],
)
def test_what_is_no_unit_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="is not a unit"):
        unit(text)


@pytest.mark.parametrize("text", ["bit", "count", "gauss", "m^0.5", "m**0.5", "byte/s"])
def test_units_that_fmi_cannot_say_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=f"unit '{text}' cannot be written in FMI's base units".replace("^", r"\^").replace("*", r"\*")):  # fmt: skip
        unit(text)


# ---------------------------------------------------------------------- conversion

SAME = [
    *[("m", other) for other in ("km", "nmi", "ft", "inch")],
    *[("rad", other) for other in ("deg", "arcmin", "rev")],
    *[("Pa", other) for other in ("bar", "psi", "atm")],
    *[("K", other) for other in ("degC", "degF")],
    ("m/s", "kn"),
    ("1", "%"),
]


@pytest.mark.parametrize(("a", "b"), SAME)
def test_there_and_back_again(a: str, b: str) -> None:
    factor, offset = conversion(a, b)
    back, shift = conversion(b, a)
    assert factor * back == pytest.approx(1.0, rel=3e-16)
    for x in (-40.0, 0.0, 1.0, 273.15, 1e5):
        assert back * (factor * x + offset) + shift == pytest.approx(x, rel=1e-13, abs=1e-12)


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [("ft", "inch", 12.0), ("h", "min", 60.0), ("deg", "arcmin", 60.0), ("rev", "deg", 360.0), ("nmi", "m", 1852.0), ("rpm", "deg/s", 6.0), ("kWh", "MJ", 3.6), ("kn", "nmi/h", 1.0), ("%", "ppm", 1e4)],
)  # fmt: skip
def test_whole_ratios_are_exact(a: str, b: str, expected: float) -> None:
    assert conversion(a, b) == (expected, 0.0)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        *(("rad", "1"), ("deg", "1"), ("deg", "%"), ("rad/s", "1/s"), ("rpm", "Hz")),
        *(("N.m", "N.m/rad"), ("N.m", "N"), ("kg", "N"), ("m", "s"), ("sr", "1"), ("Nm", "N.m")),
    ],
)
def test_what_does_not_measure_the_same_is_refused(a: str, b: str) -> None:
    """An angle is not a pure number, so a count does not pass for one."""
    for source, target in ((a, b), (b, a)):
        with pytest.raises(InputError, match=f"unit '{source}' cannot be converted to '{target}'"):
            conversion(source, target)


# ---------------------------------------------------------------------- quantities


@pytest.mark.parametrize(
    ("text", "target", "expected"),
    [
        ("1100 us", "s", 0.0011),
        ("1100us", "s", 0.0011),
        ("-5 %", "1", -0.05),
        ("10 %", "%", 10.0),
        ("0.3 ms", "s", 0.0003),
        ("10 deg", "rad", math.radians(10)),
        ("-10 deg", "deg", -10.0),
        ("180 deg", "rad", math.pi),
        ("1e3 mm", "m", 1.0),
        ("1.5E-3 km", "m", 1.5),
        (" +2.5   kn ", "kn", 2.5),
        (".5 m", "m", 0.5),
        ("5. m", "m", 5.0),
        ("4 1/min", "1/s", 4 / 60),
        ("3 ft", "m", 0.9144),
        ("30 l/min", "m3/s", 0.0005),
        ("7.2 km/h", "m/s", 2.0),
        ("5", "1", 5.0),
        ("5", "%", 5.0),
        ("-0.25 ", "1", -0.25),
        (5, "kg", 5.0),
        (-0.25, "rad", -0.25),
        (10**15, "m", 1e15),
        ("1e-999999999 m", "m", 0.0),
        ("2\tm", "m", 2.0),
    ],
)
def test_quantities_are_the_nearest_double(text, target: str, expected: float) -> None:
    value = quantity(text, target)
    assert type(value) is float
    assert value == expected


NUMBERS = st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**12), max_value=10**12)


@given(NUMBERS, st.sampled_from([("us", -6), ("ms", -3), ("ns", -9), ("ks", 3), ("s", 0)]))
def test_decimal_prefixes_only_move_the_point(number: Decimal, prefix: tuple[str, int]) -> None:
    name, power = prefix
    digits = f"{number:f}"
    assert quantity(f"{digits} {name}", "s") == float(f"{digits}e{power}")


@given(NUMBERS, st.sampled_from([("deg", "rad"), ("kn", "m/s"), ("degF", "degC"), ("psi", "bar")]))
def test_quantities_agree_with_their_conversion(number: Decimal, units: tuple[str, str]) -> None:
    factor, offset = conversion(*units)
    expected = float(number) * factor + offset
    size = max(abs(float(number) * factor), abs(offset))
    assert quantity(f"{number:f} {units[0]}", units[1]) == pytest.approx(expected, abs=1e-15 * size)


@pytest.mark.parametrize(
    ("text", "target", "message"),
    [
        ("10", "m", r"'10' has no unit; write for example '10 m'"),
        ("-0.5 ", "rad", r"has no unit; write for example '-0\.5 rad'"),
        ("10 m", "s", "unit 'm' cannot be converted to 's'"),
        ("10 deg", "1", "unit 'deg' cannot be converted to '1'"),
        ("10 %", "rad", "unit '%' cannot be converted to 'rad'"),
        ("10 metters", "m", "'metters' is not a unit"),
        ("ten m", "m", r"'ten m' is not a quantity such as '10 m'"),
        ("", "m", "'' is not a quantity"),
        ("m", "m", "'m' is not a quantity"),
        ("- 5 m", "m", "'- 5 m' is not a quantity"),
        ("nan", "1", "'nan' is not a quantity"),
        ("inf m", "m", "'inf m' is not a quantity"),
        ("1/2 m", "m", "'/2 m' is not a unit"),
        ("1_000 m", "m", "'_000 m' is not a unit"),
        ("0x10 m", "m", "'x10 m' is not a unit"),
        ("1,5 m", "m", "',5 m' is not a unit"),
        ("5 m 3", "m", "'m 3' is not a unit"),
        ("1e400 m", "m", "'1e400 m' is not a finite number"),
        ("1e308 km", "m", "'1e308 km' is not a finite number"),
        ("-1e400", "1", "is not a finite number"),
        (math.inf, "m", "inf is not a finite number"),
        (math.nan, "m", "nan is not a finite number"),
        (10**400, "m", "is not a finite number"),
        (True, "1", r"True is not a quantity such as '10 1'"),
        (None, "m", r"None is not a quantity"),
        ([1.0], "m", r"\[1\.0\] is not a quantity"),
        (1j, "m", r"1j is not a quantity"),
    ],
)
def test_quantities_that_are_refused(text, target: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        quantity(text, target)


@pytest.mark.slow
@given(st.text(max_size=12), st.sampled_from(["m", "1", "rad"]))
def test_any_text_is_a_finite_number_or_refused(text: str, target: str) -> None:
    for written in (text, f"3 {text}"):
        try:
            value = quantity(written, target)
        except InputError:
            continue
        assert math.isfinite(value)


@given(st.text(alphabet="kmsNrad.0123456789-*/^() e", max_size=12))
def test_anything_like_a_unit_is_one_or_refused(text: str) -> None:
    try:
        measure = unit(text)
    except InputError:
        return
    assert 0.0 <= measure.factor < math.inf
    assert measure.exact_factor > 0
    assert set(measure.exponents) <= set(BASE)


# ---------------------------------------------------------------------- units that FMUs define


def test_a_definition_that_says_what_the_name_says_is_exact() -> None:
    for text in ("deg", "rpm", "rev/min", "1/min", "m/s2", "K.s", "degC", "kn", "degF"):
        named = unit(text)
        for powers in (named.exponents, {n: p for n, p in named.exponents.items() if n != "rad"}):
            assert defined_unit(text, {**powers, "mol": 0}, named.factor, named.offset) is named
    assert conversion(defined_unit("deg", {}, math.pi / 180, 0.0), "rad") == conversion(
        "deg", "rad"
    )


def test_a_definition_is_the_truth_for_its_name() -> None:
    strange = defined_unit("kn", {"m": 1, "s": -1}, 2.0, 0.0)
    assert conversion(strange, "m/s") == (2.0, 0.0)
    assert conversion(strange, defined_unit("kn", {"m": 1, "s": -1}, 4.0, 0.0)) == (0.5, 0.0)
    assert quantity("10 m/s", strange) == 5.0
    assert quantity("10 kn", strange) == 10.0  # whoever writes for this port means its unit
    assert quantity(3, strange) == 3.0


def test_definitions_with_an_offset() -> None:
    reaumur = defined_unit("degRe", {"K": 1}, 1.25, 273.15)
    assert quantity("80 degRe", reaumur) == 80.0
    assert conversion(reaumur, "degC") == (1.25, 0.0)
    assert quantity("100 degC", reaumur) == 80.0
    assert conversion("K", reaumur) == (0.8, -218.52)


def test_radians_may_be_left_out_of_definitions_only() -> None:
    turn = defined_unit("lap", {}, 6.25, 0.0)
    assert conversion(turn, "rad") == (6.25, 0.0)
    assert conversion(defined_unit("lap", {"rad": 1}, 6.25, 0.0), turn) == (1.0, 0.0)
    # Hz is no angle per time by its name, whoever defines it.
    hertz = defined_unit("Hz", {"s": -1}, 1.0, 0.0)
    with pytest.raises(InputError, match="unit 'Hz' cannot be converted to 'rad/s'"):
        conversion(hertz, defined_unit("rad/s", {"s": -1}, 1.0, 0.0))
    with pytest.raises(InputError, match="unit 'lap' cannot be converted to 'm'"):
        conversion(turn, "m")


def test_names_need_to_be_known_only_if_they_differ() -> None:
    assert conversion("smoot", "smoot") == (1.0, 0.0)
    assert quantity("5 smoot", "smoot") == 5.0
    assert quantity(5, "smoot") == 5.0
    with pytest.raises(
        InputError, match=r"'smoot' is not a unit .*; unit 'm' cannot be converted to 'smoot'"
    ):
        conversion("m", "smoot")
    with pytest.raises(InputError, match="'5' has no unit; write for example '5 smoot'"):
        quantity("5", "smoot")


@pytest.mark.parametrize(("factor", "offset"), [(0.0, 0.0), (-1.0, 0.0), (math.nan, 0.0), (math.inf, 0.0), (1.0, math.inf)])  # fmt: skip
def test_definitions_that_convert_nothing(factor: float, offset: float) -> None:
    with pytest.raises(InputError, match="unit 'm' has factor"):
        defined_unit("m", {"m": 1}, factor, offset)


@given(st.floats(1e-30, 1e30), st.floats(1e-30, 1e30), FACTORS)
def test_definitions_convert_by_the_ratio_of_their_factors(a: float, b: float, powers) -> None:
    one, two = (defined_unit(f"own {f!r}", powers, f, 0.0) for f in (a, b))
    assert isinstance(one, Unit)
    assert conversion(one, two) == (pytest.approx(a / b, rel=1e-15), 0.0)
