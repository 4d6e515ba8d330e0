"""Clocks of FMI 3.0 in co-simulation, of a slave that refuses a tick at a wrong time."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from typer.testing import CliRunner

from seatrial.cli.fmu import fmu_app
from seatrial.errors import InputError, SimulationError
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import changed, read, started

KINDS = ("sample", "third", "tuned", "widening")
STEP = Fraction(7, 1000)


@pytest.fixture
def clocks(native_fmu, tmp_path: Path):
    """Return a function that makes a started instance, with changes of its description."""
    opened = []

    def start(*changes: tuple[str, str], **values):
        path = changed(native_fmu("clocks"), tmp_path / "clocks.fmu", *changes)
        opened.append(open_instance(load_fmu(path), "it"))
        return started(opened[-1], **values)

    yield start
    for instance in opened:
        instance.free()


def run(instance, until: float, step: Fraction = STEP, begin: float = 0.0) -> list[list[object]]:
    """Step to ``until``; return how often and when each kind of clock ticked last, per step."""
    get = instance.reader([f"{what}_{kind}" for kind in KINDS for what in ("count", "when")])
    rows = []
    for k in range(round(begin / step), round(until / step)):
        instance.step(float(k * step), float((k + 1) * step) - float(k * step))
        rows.append(get())
    return rows


def expected(t: Fraction) -> list[object]:
    """Return what `run` has at ``t``, from the definitions of the clocks."""
    sample = (t - Fraction(1, 100)) // Fraction(3, 100)  # shift 0.01 s, interval 0.03 s
    third = t // Fraction(1, 3)
    tuned = (t - Fraction(5, 1000)) // Fraction(2, 100)
    widening = 0
    while sum(range(widening + 2)) * Fraction(1, 100) <= t:  # intervals of 0.01, 0.02, 0.03 ... s
        widening += 1
    found: list[object] = []
    for count, last in (
        (sample + 1, Fraction(1, 100) + sample * Fraction(3, 100)),
        (third + 1, third * Fraction(1, 3)),
        (tuned + 1, Fraction(5, 1000) + tuned * Fraction(2, 100)),
        (widening, sum(range(widening + 1)) * Fraction(1, 100)),
    ):
        found += [count, pytest.approx(float(last) if count else 0.0, abs=1.001e-9)]
    return found


@pytest.mark.parametrize("step", [STEP, Fraction(1, 10), Fraction(5, 10_000)])
def test_every_kind_ticks_at_its_time_whatever_the_step(clocks, step: Fraction) -> None:
    instance = clocks()
    for k, row in enumerate(run(instance, 1.4, step)):
        assert row == expected((k + 1) * step), (k + 1) * step


@pytest.mark.slow
def test_ticks_do_not_drift(clocks) -> None:
    """After 300 ticks a third of a second is still one, to the nanosecond."""
    instance = clocks()
    for k in range(100):
        instance.step(float(k), 1.0)
    count, when = read(instance, "count_third", "when_third")
    assert (count, when) == (301, 100.0)


def test_clocked_variables_are_exchanged_when_their_clock_ticks(clocks) -> None:
    """``sum`` adds ``u`` at 0.01, 0.04, 0.07 s; between ticks it is as it was."""
    instance = clocks(u=2.0)
    write, sums = instance.writer(["u"]), []
    for k in range(10):
        write([float(k)])
        instance.step(k * 0.01, 0.01)
        sums += read(instance, "sum")
    assert sums == [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 9.0, 9.0, 9.0, 18.0]
    assert read(instance, "u") == [9.0]


def test_an_interval_that_is_tuned_counts_from_then(clocks) -> None:
    instance = clocks()
    run(instance, 0.035)  # ticks at 5 and 25 ms
    instance.writer(["pace"])([0.05])
    run(instance, 0.175, begin=0.035)  # and at 85 and 135 ms
    assert read(instance, "count_tuned", "when_tuned") == [4, pytest.approx(0.135)]


def test_a_countdown_begins_when_it_is_known(clocks) -> None:
    instance = clocks()
    run(instance, 0.049)
    assert read(instance, "count_delayed") == [0]
    instance.writer(["start"])([True])
    run(instance, 0.07, begin=0.049)
    assert read(instance, "count_delayed") == [0]
    run(instance, 0.077, begin=0.07)
    assert read(instance, "count_delayed", "when_delayed") == [1, pytest.approx(0.049 + 0.025)]


def test_a_countdown_that_belongs_to_a_clock_is_known_when_that_ticks(clocks) -> None:
    """``sample`` ticks at 70 ms: the 25 ms begin there, not at 49 ms."""
    instance = clocks(('"countdown"', '"countdown" clocks="1"'))
    run(instance, 0.049)
    instance.writer(["start"])([True])
    run(instance, 0.14, begin=0.049)
    assert read(instance, "count_delayed", "when_delayed") == [1, pytest.approx(0.07 + 0.025)]


def test_a_countdown_of_nothing_ticks_again_at_once(clocks) -> None:
    instance = clocks(chain=3)
    instance.writer(["start"])([True])
    run(instance, 0.07)
    assert read(instance, "count_delayed", "when_delayed") == [4, pytest.approx(0.025)]


def test_one_that_never_ends_is_an_error(clocks) -> None:
    instance = clocks(chain=10_000)
    instance.writer(["start"])([True])
    with pytest.raises(SimulationError, match="it: an event is not over after 1000 calls"):
        run(instance, 0.07)


def test_a_triggered_input_is_a_signal_of_truth(clocks) -> None:
    """Each true step is one tick, at its beginning, with the variables of the clock."""
    instance = clocks()
    write = instance.writer(["poke", "word"])
    for k, (poke, word) in enumerate([(False, b"a"), (True, b"bc"), (True, b"d\0e"), (False, b"")]):
        write([poke, word])
        instance.step(k * 0.01, 0.01)
        expected = [(0, b"", False, 0), (1, b"cb", False, 0), (2, b"e\0d", True, 1)][min(k, 2)]
        second = expected[2] and k == 2  # it is active with every second poke
        assert read(instance, "count_poke", "answer", "second", "seconds") == [
            *expected[:2], second, expected[3],
        ]  # fmt: skip


def test_a_triggered_output_is_one_in_the_step_of_its_tick(clocks, caplog) -> None:
    instance = clocks(alarm_every=0.018)
    seen = []
    for k in range(10):
        instance.step(k * 0.01, 0.01)
        seen += [read(instance, "alarm", "count_alarm", "when_alarm")]
    assert [row[0] for row in seen] == [k in (1, 3, 5, 7, 8) for k in range(10)]
    assert seen[-1] == [False, 5, pytest.approx(0.09)]
    assert not caplog.records


def test_a_signal_shows_two_ticks_in_a_step_as_one_and_says_so(clocks, caplog) -> None:
    instance = clocks(alarm_every=0.018)
    instance.step(0.0, 0.1)
    instance.step(0.1, 0.1)
    assert read(instance, "alarm", "count_alarm") == [True, 11]
    (record,) = caplog.records
    assert "alarm was active more than once in the step to t = 0.1 s" in record.getMessage()


def test_a_rollback_takes_all_clocks_back(clocks) -> None:
    instance = clocks(alarm_every=0.018)
    instance.writer(["start"])([True])
    before = run(instance, 0.049)
    state = instance.get_state()
    instance.writer(["poke", "u", "pace"])([True, 5.0, 0.003])
    run(instance, 0.35, begin=0.049)
    for _ in range(2):
        instance.set_state(state)
        rows = [f"{what}_{kind}" for kind in KINDS for what in ("count", "when")]
        assert read(instance, *rows, "poke") == [*before[-1], False]
        instance.writer(["poke", "u", "pace"])([False, 0.0, 0.02])
        assert run(instance, 1.4, begin=0.049)[-1] == expected(Fraction(14, 10))
        assert read(instance, "count_poke", "count_delayed") == [0, 1]
    instance.free_state(state)


VARIABLE_STEPS = ('canHandleVariableCommunicationStepSize="true"', "")


def test_without_steps_of_other_lengths_the_rigs_step_has_to_fit(clocks) -> None:
    instance = clocks(VARIABLE_STEPS)
    with pytest.raises(SimulationError, match=r"it: a clock ticks at t = 0\.005 s, between two"):
        instance.step(0.0, 0.01)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('intervalDecimal="0.03"', 'intervalDecimal="0"', r"an interval of 0\.0 s; 1e-09 s at"),
        ('intervalDecimal="0.03"', 'intervalDecimal="soon"', "interval: 'soon' / 1 is no time"),
        ('intervalDecimal="0.03"', 'intervalDecimal="1e999999999"', "interval: '1e999999999' / 1"),
        (
            'intervalDecimal="0.03"',
            'intervalDecimal="1e-999999999"',
            r"an interval of 0\.0 s; 1e-09",
        ),
        ('intervalDecimal="0.03"', "", "a constant clock needs an intervalDecimal"),
        ('shiftDecimal="0.01"', 'shiftDecimal="-0.01"', r"an interval of -0\.01 s; 0\.0 s at"),
        ('resolution="3"', 'resolution="0"', "interval: '1' / 0 is no time"),
        (
            'causality="output" intervalVariability="triggered"/>',
            'causality="output" intervalVariability="countdown"/>',
            "a clock of causality output is triggered, found 'countdown'",
        ),
        ('"countdown"', '"sometimes"', "intervalVariability 'sometimes'"),
        (
            'causality="output" intervalVariability="triggered" clocks="6"',
            'causality="input" intervalVariability="triggered" clocks="6"',
            "an input clock that belongs to another clock is a countdown, found 'triggered'",
        ),
    ],
)
def test_clocks_that_cannot_be(native_fmu, tmp_path: Path, before, after, message) -> None:
    path = changed(native_fmu("clocks"), tmp_path / "x.fmu", (before, after))
    with pytest.raises(InputError, match=rf"x\.fmu: variable '\w+' \(line \d+\): .*{message}"):
        load_fmu(path)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"pace": 0.0}, r"it: interval of the tunable clock tuned: an interval of 0\.0 s"),
        ({"pace": float("inf")}, "it: interval of the tunable clock tuned: it is no number"),
    ],
)
def test_intervals_that_cannot_be(clocks, values, message: str) -> None:
    with pytest.raises(SimulationError, match=message):
        clocks(**values)


def test_the_checker_knows_clocks_that_have_a_type(native_fmu) -> None:
    """FMPy's does not, and would say nothing else of such an FMU."""
    result = CliRunner().invoke(fmu_app, ["check", str(native_fmu("clocks"))])
    assert "declaredType" not in result.output
    assert "ModelStructure" in result.output  # of what the slave's description lacks


def test_describe_lists_when_clocks_tick(native_fmu) -> None:
    result = CliRunner().invoke(fmu_app, ["describe", str(native_fmu("clocks"))])
    lines = [line for line in result.output.splitlines() if line.startswith("clock ")]
    assert lines[0] == "clock sample: constant, every 0.03 s from 0.01 s"
    assert lines[4:6] == ["clock delayed: countdown", "clock poke: triggered"]
    assert len(lines) == 8


def test_local_clocks_are_a_note(native_fmu, tmp_path: Path) -> None:
    edit = ('name="alarm" valueReference="7" causality="output"', 'name="alarm" valueReference="7" causality="local"')  # fmt: skip
    fmu = load_fmu(changed(native_fmu("clocks"), tmp_path / "x.fmu", edit))
    (note,) = fmu.notes
    assert note.endswith("are no signals: alarm, count_alarm, when_alarm")
    assert not {"alarm", "count_alarm"} & set(fmu.variables)
