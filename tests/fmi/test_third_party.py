"""FMUs of others in rigs: values that people write, units, whole arrays, rollback."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from .native import changed, forgetful


@pytest.fixture
def rig(native_fmu, write):
    """Return a function that runs a rig of both slaves to its start."""
    masters = []

    def start(components: str, connections: str = "", algorithm: str = "jacobi") -> Master:
        text = f'step = "100 ms"\nalgorithm = "{algorithm}"\n[components]\n{components}\n'
        for name in ("fmi2", "fmi3"):
            text = text.replace(f'"{name}"', f'"{native_fmu(name)}"')
        path = write("rig.toml", f"{text}[connections]\n{connections}\n")
        masters.append(Master(assemble(load_rig(str(path))), 0, 10**10))
        masters[-1].initialise()
        return masters[-1]

    yield start
    for master in masters:
        master.system.free()


def values(master: Master, *names: str) -> list[object]:
    signals = dict(zip((".".join(n) for n in master.names), master.signals, strict=True))
    return [signals[name] for name in names]


@pytest.mark.parametrize("isolated", ["true", "false"])
@pytest.mark.parametrize("kind", ["fmi2", "fmi3"])
def test_a_decay_in_a_rig(kind: str, isolated: str, rig) -> None:
    master = rig(f'a = {{ fmu = "{kind}", isolated = {isolated}, set = {{ k = 0.5 }} }}')
    for _ in range(40):
        master.step()
    assert values(master, "a.x") == [pytest.approx(math.exp(-2.0), rel=1e-13)]
    master.terminate()


@pytest.mark.parametrize("kind", ["fmi2", "fmi3"])
def test_a_discarded_step_is_taken_in_parts(kind: str, rig) -> None:
    master = rig(f'a = {{ fmu = "{kind}", set = {{ largest_step = 0.03 }} }}')
    for _ in range(5):
        master.step()
    assert values(master, "a.x") == [pytest.approx(math.exp(-0.5), rel=1e-13)]


def test_whole_arrays_and_every_type_cross_a_connection(rig) -> None:
    master = rig(
        'a = { fmu = "fmi3", set = { in_Float64 = [1, 2, 3], in_String = ["x", "é", ""], '
        'in_Binary = ["AP8=", "", "YWJj"], in_UInt8 = 7, in_Boolean = true, in_Mode = "sail", '
        'in_Int64 = 9007199254740993 } }\nb = { fmu = "fmi3" }\nc = { fmu = "fmi2" }',
        "\n".join(f'"a.out_{t}" = "b.in_{t}"' for t in ("Float64", "String", "Binary", "UInt8", "Boolean", "Int64", "Mode"))
        + '\n"a.out_Float64[3]" = "c.u"\n"a.out_Boolean[1]" = "c.b"\n"a.out_UInt8[2]" = "c.i"',
    )  # fmt: skip
    assert values(master, "b.out_Float64[1]", "b.out_Float64[3]", "c.y", "c.c", "c.j") == [
        4.0,
        12.0,
        12.0,
        True,
        28,
    ]
    assert values(master, "b.out_String[2]", "b.out_Binary[1]", "b.out_Binary[3]") == [
        "é",
        b"\x00\xff",
        b"abc",
    ]
    assert values(master, "b.out_UInt8[2]", "b.out_Boolean[2]", "b.out_Mode") == [
        28,
        True,
        5_000_000_000,
    ]
    assert values(master, "b.out_Int64[1]") == [4 * 9007199254740993]
    master.step()
    assert values(master, "b.out_Float64[1]") == [4.0]


def test_arrays_are_connected_by_index_whatever_the_order_of_declaration(rig) -> None:
    master = rig(
        'a = { fmu = "fmi2", set = { q = [1, 10] } }\nb = { fmu = "fmi2" }', '"a.p" = "b.q"'
    )
    assert values(master, "b.p[1]", "b.p[2]") == [4.0, 40.0]


def test_a_value_that_does_not_fit_its_type_on_the_way(rig) -> None:
    with pytest.raises(
        SimulationError, match=r"b\.in_UInt8\[1\]: 400 does not fit its type, 0 to 255"
    ):
        rig(
            'a = { fmu = "fmi3", set = { in_Int16 = 200 } }\nb = { fmu = "fmi3" }',
            '"a.out_Int16" = "b.in_UInt8"',
        )


UNITS = [
    ("10 knot_x", 10.0),
    ("18.52 km/h", 10.0),
    ("10 kn", 10.0),
    (4, 4.0),
]


@pytest.mark.parametrize(("written", "expected"), UNITS)
def test_quantities_in_a_unit_that_only_the_fmu_knows(written, expected: float, rig) -> None:
    master = rig(f'a = {{ fmu = "fmi2", set = {{ speed = {written!r} }} }}'.replace("'", '"'))
    assert values(master, "a.echo") == [pytest.approx(expected, rel=1e-12)]


def test_connections_convert_by_definition(rig, native_fmu, tmp_path: Path) -> None:
    metres = changed(
        native_fmu("fmi2"), tmp_path / "si.fmu", ('name="knot_x"><BaseUnit m="1" s="-1" factor="0.5144444444444445"',
        'name="m/s"><BaseUnit m="1" s="-1"'), ('unit="knot_x"', 'unit="m/s"'),
    )  # fmt: skip
    master = rig(
        f'a = {{ fmu = "fmi2", set = {{ speed = 10 }} }}\nb = {{ fmu = "{metres}" }}\nc = {{ fmu = "fmi2" }}',
        '"a.echo" = "b.speed"\n"b.echo" = "c.speed"',
    )
    assert values(master, "b.echo", "c.echo") == [
        pytest.approx(5.144444444444445, rel=1e-15),
        pytest.approx(10.0, rel=1e-15),
    ]


def test_units_that_nobody_defines(rig, native_fmu, tmp_path: Path) -> None:
    bare = {
        name: changed(
            native_fmu("fmi2"), tmp_path / f"{name}.fmu",
            ('<BaseUnit m="1" s="-1" factor="0.5144444444444445"/>', ""), ("knot_x", name),
        )
        for name in ("smoot", "smoots per blink")
    }  # fmt: skip
    first, second = bare.values()
    master = rig(
        f'a = {{ fmu = "{second}", set = {{ speed = "3 smoots per blink" }} }}\nb = {{ fmu = "{second}" }}',
        '"a.echo" = "b.speed"',
    )
    assert values(master, "b.echo") == [3.0]
    with pytest.raises(
        InputError,
        match=r"echo to speed: 'smoot' is not a unit .* cannot be converted to 'smoots per blink'",
    ):
        rig(f'a = {{ fmu = "{first}" }}\nb = {{ fmu = "{second}" }}', '"a.echo" = "b.speed"')
    with pytest.raises(InputError, match="unit 'knot_x' cannot be converted to 'kg'"):
        kilo = changed(
            native_fmu("fmi2"), tmp_path / "kg.fmu", ('Real unit="knot_x"', 'Real unit="kg"')
        )
        rig(f'a = {{ fmu = "fmi2" }}\nb = {{ fmu = "{kilo}" }}', '"a.echo" = "b.speed"')


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("in_UInt8 = 300", "a whole number from 0 to 255 is needed, found 300"),
        ("in_Int64 = 1.5", "a whole number from .* is needed, found 1.5"),
        ('in_Int8 = "two"', "two"),
        ('in_Mode = "swim"', r"one of drift \(1\), sail \(5000000000\) is needed, found 'swim'"),
        ("in_Mode = 2", "found 2"),
        ("in_Boolean = 1", "true or false is needed, found 1"),
        ("in_String = 1", "a text is needed, found 1"),
        ('in_String = "a\\u0000b"', "FMI cannot carry"),
        ('in_Binary = "not base64!"', "bytes as base64 text are needed"),
        ("in_Binary = 5", "bytes as base64 text are needed"),
        ("in_Float64 = [1, 2]", r"3 values are needed \(in_Float64\[1\], .*found 2"),
        ("rows = -2", "set.rows: a whole number from 0 to"),
        ("tick = true", "unknown port 'tick'"),
        ("steps = 1", "steps has the causality output and cannot be set"),
    ],
)
def test_values_that_do_not_fit(setting: str, message: str, rig) -> None:
    with pytest.raises(InputError, match=message) as caught:
        rig(f'a = {{ fmu = "fmi3", set = {{ {setting} }} }}')
    assert "rig.toml" in str(caught.value)


def test_limits_of_parameters_hold(rig) -> None:
    with pytest.raises(InputError, match=r"k = -1\.0  is not in its range 0\.0 <= k"):
        rig('a = { fmu = "fmi2", set = { k = -1 } }')


def test_unconnected_inputs_are_named_by_their_port(rig) -> None:
    master = rig('a = { fmu = "fmi2", set = { u = 1, "q[1]" = 1 } }')
    assert master.system.unconnected_inputs() == [
        f"a.{name}" for name in ("q[2]", "speed", "i", "mode_in", "b", "s")
    ]
    master = rig('a = { fmu = "fmi2" }')
    assert master.system.unconnected_inputs()[:3] == ["a.u", "a.q", "a.speed"]


def test_a_value_that_is_not_finite_is_named(rig) -> None:
    master = rig('a = { fmu = "fmi2", set = { trouble = "nan", trouble_time = 0.25 } }')
    master.step()
    master.step()
    with pytest.raises(SimulationError, match=r"a\.x is nan at t = 0\.3 s"):
        master.step()


@pytest.mark.parametrize(
    ("trouble", "message"),
    [("error", "returned error: 100% wrong"), ("fatal", "returned fatal")],
)
def test_a_failing_fmu_ends_the_run_with_what_it_said(trouble: str, message: str, rig) -> None:
    master = rig(f'a = {{ fmu = "fmi2", set = {{ trouble = "{trouble}" }} }}')
    with pytest.raises(SimulationError, match=message):
        master.step()


@pytest.mark.parametrize("isolated", ["true", "false"])
@pytest.mark.parametrize("algorithm", ["jacobi", "iterated"])
def test_an_fmu_that_cannot_restore_its_state_although_it_says_so(
    algorithm: str, isolated: str, rig, native_fmu, tmp_path: Path
) -> None:
    """It answers ok; what it gives after a step was repeated would be wrong, and look right."""
    path = forgetful(native_fmu("fmi2"), tmp_path / "forgetful.fmu")
    master = rig(
        f'a = {{ fmu = "{path}", isolated = {isolated} }}\n'
        'b = { fmu = "fmi2", set = { largest_step = 0.03 } }',
        '"a.x" = "b.u"',
        algorithm,
    )
    with pytest.raises(
        SimulationError,
        match=r"a says that it can save .* but it cannot: x was 1\.0 when .* t = 0\.0 s, and is 0\.9",
    ):
        master.step()
