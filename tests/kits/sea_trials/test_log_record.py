"""Logs of real trials as CSV files."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.logs.quantities import read_columns
from seatrial_kits.sea_trials.figures.turning import turning_circle
from seatrial_kits.sea_trials.log_record import read_record

from .references import FOLDER, columns, record

NAMES = "time=t, north=x,east=y,heading=psi,helm=delta"
TURN = "kvlcc2_full_turn_m35"


def write(path, header, rows, form="%.9f"):
    text = "\n".join(",".join(form % cell for cell in row) for row in rows)
    path.write_text(f"{header}\n{text}\n", "utf-8")
    return path


def test_the_second_line_has_the_units():
    read = read_record(FOLDER / f"{TURN}.csv", read_columns([NAMES]))[0]
    assert np.array_equal(read.heading, record(TURN).heading)
    assert np.array_equal(read.helm, record(TURN).helm)


def test_units_on_the_command_line_and_wrapped_degrees(tmp_path):
    time, north, east, heading, helm = columns(TURN)
    rows = np.column_stack((time / 60.0, north / 1852.0, east / 1852.0,
                            np.degrees(heading) % 360.0, np.degrees(helm)))  # fmt: skip
    path = write(tmp_path / "log.csv", "UTC,N,E,HDG,RUD", rows)
    texts = ["time=UTC:min,north=N:nautical_mile", "east=E:nautical_mile",
             "heading=HDG:deg,helm=RUD:deg"]  # fmt: skip
    found = turning_circle(read_record(path, read_columns(texts))[0])
    expected = turning_circle(record(TURN))
    assert found["advance"] == pytest.approx(expected["advance"], rel=1e-5)
    assert found["tactical_diameter"] == pytest.approx(expected["tactical_diameter"], rel=1e-5)


def test_latitude_and_longitude_become_metres(tmp_path):
    # One minute of latitude at 45 deg is 1852.2 m, one of longitude 1314.2 m (WGS 84).
    minute = 1.0 / 60.0
    rows = [(t, 45.0 + minute * t / 9.0, 7.0 + minute * t / 9.0, 0.0) for t in range(10)]
    path = write(tmp_path / "log.csv", "time,latitude,longitude,heading\ns,deg,deg,deg", rows)
    read = read_record(path, {})[0]
    assert read.north[-1] == pytest.approx(1852.2, abs=0.5)
    assert read.east[-1] == pytest.approx(1314.2, abs=0.5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("heading", "WHAT=NAME or WHAT=NAME:UNIT is needed, found 'heading'"),
        ("heading=psi:", "found 'heading=psi:'"),
        ("course_=psi", "unknown quantity 'course_'"),
    ],
)
def test_columns_of_another_form_are_refused(text, message):
    with pytest.raises(InputError, match=message):
        read_columns([text])


@pytest.mark.parametrize(
    ("header", "cell", "texts", "message"),
    [
        ("time,north,east,psi", "1", [], "no column serves as heading; .* psi"),
        ("time,north,east,heading", "1", ["heading=HDG"], "heading: unknown column 'HDG'"),
        ("time,north,east,heading", "x", [], "line 9, column 'heading': a finite .* 'x'"),
        ("time,north,east,heading", "1,2", [], "line 9: 5 values, the header has 4"),
        ("time,north,east,heading", "1", ["heading=heading:m"], "column 'heading': unit 'm'"),
        ("time,north,east,heading\ns,m,m,rad", "1", ["heading=heading:deg"], "in rad, not deg"),
        ("time,north,east,heading", "1", [], "line 9: the time goes from 6 s to 3 s"),
    ],
)
def test_bad_files_are_refused(tmp_path, header, cell, texts, message):
    rows = "".join(f"{t},0,0,0\n" for t in range(7))
    path = tmp_path / "log.csv"
    path.write_text(f"{header}\n{rows}3,0,0,{cell}\n", "utf-8")
    with pytest.raises(InputError, match=message):
        read_record(path, read_columns(texts))[0]


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match=r"there is no log .*none\.csv"):
        read_record(tmp_path / "none.csv", {})[0]


def test_degrees_without_a_unit_are_refused(tmp_path):
    time, north, east, heading, helm = columns(TURN)
    rows = np.column_stack((time, north, east, np.degrees(heading) % 360.0, np.degrees(helm)))
    path = write(tmp_path / "log.csv", "time,north,east,heading,helm", rows)
    with pytest.raises(InputError, match="radians, or shares of full helm"):
        read_record(path, {})[0]
    assert math.degrees(helm[-1]) == pytest.approx(-35.0)
