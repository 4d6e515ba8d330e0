"""Logs of users: what is read, and what is refused with its place."""

import numpy as np
import pytest

from benchmarks.identification import CASES, synthetic
from seatrial.errors import InputError
from seatrial_kits.identify.studies.experiment import load_experiment
from seatrial_kits.identify.studies.log_file import read_log

from .conftest import EXPERIMENT

YAW = (
    EXPERIMENT.replace("surge", "yaw").replace("6.5 kg", "0.122 kg.m2").replace("93.41 N", "9 N.m")
)
YAW = YAW.replace('acceleration = { name = "ax", unit = "cm/s2" }', 'heading = { name = "psi", unit = "deg" }')  # fmt: skip


def log_of(path):
    experiment = load_experiment(str(path))
    return read_log(experiment, experiment.log_path(None))


def changed(surge, column, row, cell):
    cells = list(surge[column])
    cells[row] = cell
    return {**surge, column: cells}


def test_units_and_gravity(pool):
    log = log_of(pool())
    exact = synthetic(CASES[1], 11).log
    np.testing.assert_allclose(log.command, exact.command[:600], atol=1e-15)
    np.testing.assert_allclose(log.measured, exact.measured[:600], atol=1e-12)
    assert log.period == pytest.approx(0.1, rel=1e-12)
    assert (log.reading, log.rotation) == ("acceleration", False)


def test_a_heading_that_wraps_is_counted_on(pool, surge):
    turning = np.linspace(350.0, 350.0 + 3 * 360.0, 600)
    columns = {**surge, "psi": [repr(float(v)) for v in turning % 360.0]}
    log = log_of(pool(columns, YAW))
    np.testing.assert_allclose(np.degrees(log.measured), turning, atol=1e-9)
    assert (log.reading, log.rotation) == ("place", True)


def test_a_mark_of_windows_and_blank_lines_do_not_matter(pool):
    path = pool()
    csv = path.with_name("pool.csv")
    before = log_of(path)
    csv.write_bytes(b"\xef\xbb\xbf" + csv.read_bytes() + b"\r\n\r\n")
    np.testing.assert_array_equal(log_of(path).measured, before.measured)


@pytest.mark.parametrize(
    ("column", "row", "cell", "expected"),
    [
        ("ax", 3, "inf", "line 5, column 'ax': a finite number is needed, found 'inf'"),
        ("beta", 0, "full", "line 2, column 'beta': a finite number is needed, found 'full'"),
        ("beta", 7, "130", "line 9, column 'beta': a command from -1 to 1 is needed, found 1.3"),
        ("t", 9, "0.85", "line 11: the time goes from 0.8 s to 0.85 s, rows 0.1 s apart"),
        ("t", 9, "0.8", "line 11: the time goes from 0.8 s to 0.8 s"),
    ],
)
def test_a_cell_that_is_wrong(pool, surge, column, row, cell, expected):
    with pytest.raises(InputError, match=f"pool.csv.*{expected}"):
        log_of(pool(changed(surge, column, row, cell)))


@pytest.mark.parametrize("cell", ["", "nan"])
def test_an_empty_cell_is_between_its_neighbours(pool, surge, cell):
    whole, log = log_of(pool()), log_of(pool(changed(surge, "ax", 3, cell)))
    assert whole.measured[4] < log.measured[3] < whole.measured[2]  # a monotone cubic
    np.testing.assert_allclose(np.delete(log.measured, 3), np.delete(whole.measured, 3), atol=1e-12)


def test_a_gap_says_how_much_is_missing(pool, surge):
    gap = {name: cells[:20] + cells[23:] for name, cells in surge.items()}
    with pytest.raises(InputError, match=r"line 22: .* from 1.9 s to 2.3 s.*: 3 rows missing"):
        log_of(pool(gap))


def test_a_heading_that_turns_too_fast(pool, surge):
    columns = {**surge, "psi": ["10"] * 4 + ["150"] * 596}
    with pytest.raises(InputError, match="line 6, column 'psi': it turns by 140 deg"):
        log_of(pool(columns, YAW))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            '"pitch", unit',
            '"pitsh", unit',
            "pitch: unknown column 'pitsh'; did you mean 'pitch'",
        ),
        ('"cm/s2"', '"cm"', "column 'ax': unit 'cm' cannot be converted to 'm/s2'"),
        ('"cm/s2"', '"furlongs"', "unit 'furlongs' cannot be converted to 'm/s2'"),
        (', unit = "cm/s2"', "", "column 'ax': a unit is needed"),
        ('"pool.csv"', '"pond.csv"', "there is no log .*pond.csv"),
    ],
)
def test_columns_that_do_not_fit(pool, old, new, expected):
    with pytest.raises(InputError, match=expected):
        log_of(pool(text=EXPERIMENT.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "the file is empty"),
        ("t,beta,ax,roll,pitch\n0,1,2\n", "line 2: 3 values, the header has 5"),
        ("t,t,beta,ax,roll,pitch\n", "the column 't' occurs twice"),
        ('t,beta,ax,roll,pitch\n0,"1,2\n', "not CSV"),
        (
            "t,beta,ax,roll,pitch\n0,0,0,0,0\n1,0,0,0,0\n2,0,0,0,0\n",
            "3 rows, at least 50 are needed",
        ),
    ],
)
def test_files_that_are_no_log(pool, content, expected):
    path = pool()
    path.with_name("pool.csv").write_text(content)
    with pytest.raises(InputError, match=expected):
        log_of(path)


def test_a_command_that_never_changes(pool, surge):
    with pytest.raises(InputError, match="the command 'beta' never changes"):
        log_of(pool({**surge, "beta": ["30"] * 600}))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"surge"', '"surf"', "axis: Input should be 'surge', 'sway', 'heave' or 'yaw'"),
        ('"surge"', '"yaw"', "yaw is identified from the column heading, found acceleration"),
        (
            'pitch = { name = "pitch", unit = "deg" }\n',
            "",
            "an accelerometer reads gravity: pitch is needed too",
        ),
        ('"6.5 kg"', '"6.5 kg.m2"', "known.mass: unit 'kg.m2' cannot be converted to 'kg'"),
        ('"93.41 N"', '"0 N"', "known.thrust: above 0 is needed"),
        ("title", "tilte", "did you mean 'title'"),
    ],
)
def test_experiments_that_are_refused(pool, old, new, expected):
    with pytest.raises(InputError, match=expected):
        load_experiment(str(pool(text=EXPERIMENT.replace(old, new, 1))))


def test_heave_takes_one_sensor(pool):
    text = EXPERIMENT.replace('"surge"', '"heave"').replace(
        "roll =", 'depth = { name = "z", unit = "m" }\nroll =', 1
    )
    with pytest.raises(InputError, match="column acceleration or depth, found acceleration and depth"):  # fmt: skip
        load_experiment(str(pool(text=text)))
