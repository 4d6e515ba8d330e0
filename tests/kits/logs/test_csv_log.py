"""CSV files as people's programs write them."""

import gzip

import pytest

from seatrial.errors import InputError
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.quantities import Column, series


@pytest.fixture
def read(write):
    return lambda text, time=None, **options: read_log(
        write("boat.csv", text), time=time, **options
    )


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("time,HDG\n0,1\n1,2\n", [None, None]),
        ("time,HDG\ns,deg\n0,1\n1,2\n", ["s", "deg"]),
        ("time [s],HDG (deg)\n0,1\n1,2\n", ["s", "deg"]),
        ("time;HDG\n0,0;1,0\n1,0;2,0\n", [None, None]),
        ("time\tHDG\n0.0\t1\n1\t2\n", [None, None]),
        ("\ufefftime,HDG\r\n0,1\r\n\r\n1,2\r\n", [None, None]),
    ],
)
def test_tables(read, text, units):
    found = read(text)
    assert [each.unit for each in found.channels.values()] == units
    assert found.channels["HDG"].time.tolist() == [0.0, 1.0]
    assert found.channels["HDG"].values.tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("first", "second", "start"),
    [
        ("2024-05-01T23:59:59.5Z", "2024-05-02T00:00:01Z", "2024-05-01T23:59:59.500000+00:00"),
        ("2024-05-01 23:59:59.5", "2024-05-02 00:00:01", "2024-05-01T23:59:59.500000+00:00"),
        (
            "2024-05-01T23:59:59.5+00:00",
            "2024-05-02T02:00:01+02:00",
            "2024-05-01T23:59:59.500000+00:00",
        ),
        ("23:59:59.5", "00:00:01", None),
    ],
)
def test_dates_and_times_of_day(read, first, second, start):
    found = read(f"UTC,HDG\n{first},1\n{second},2\n", Column("UTC"))
    assert found.channels["HDG"].time.tolist() == [0.0, 1.5]
    assert (found.start and found.start.isoformat()) == start


def test_units_of_the_time(read):
    assert read("t [ms],a\n0,1\n250,2\n", Column("t")).channels["a"].time.tolist() == [0.0, 0.25]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "boat.csv: the file is empty"),
        ("nothing\n", "its format is not known; --format can name one of .*run \\("),
        ("t,a\n0,1\n", "line 1: time: unknown column 'time'.*--columns time=NAME names it"),
        ("time,a\n0,5,1,5\n", "line 2: 4 values, the header has 2; with decimal commas, ';'"),
        ("time,a\n0,1,5\n", "line 2: 3 values, the header has 2$"),
        ("time,a\n", "boat.csv: no row of values was found in it, read as CSV"),
        ("time,a\n0,1\n,2\n", "line 3, column 'time': the row has no time"),
        ("time,a,a\n0,1,5\n", "the column 'a' occurs twice"),
        ("time,a\n0,1\nx,2\n", "line 3, column 'time': a finite number is needed, found 'x'"),
        ("time,a\n12:00:00,1\n12 o'clock,2\n", "line 3, .* a time of day by ISO 8601 .* 'clock"),
        ("time,a\n2024-05-01T12:00Z,1\n12:01:00,2\n", "line 3, .* a date and time by ISO"),
    ],
)
def test_no_tables(read, text, message):
    with pytest.raises(InputError, match=message.replace("'clock", "o'clock")):
        read(text)


def test_empty_cells_have_no_value(read):
    """As loggers of several rates leave them; any other text is a mistake."""
    found = read("time,HDG,u\n0,1,\n1,,2\n2,3,nan\n3,4,abc\n")
    heading = series(found, "heading", Column("HDG"))
    assert heading.time.tolist() == [0.0, 2.0, 3.0]
    assert heading.values.tolist() == [1.0, 3.0, 4.0]
    assert found.notes == ("cells without a number, by column: HDG (1)",)
    with pytest.raises(InputError, match=r"line 5, column 'u': .* found 'abc'"):
        series(found, "speed", Column("u"))


def test_a_spreadsheet_of_windows(tmp_path):
    (tmp_path / "boat.csv").write_bytes("time;Höhe [m];Kurs [°]\n0;1;2\n".encode("cp1252"))
    assert list(read_log(tmp_path / "boat.csv").channels) == ["time", "Höhe", "Kurs"]


def test_a_folder_is_no_log(tmp_path):
    with pytest.raises(InputError, match="a folder that is neither a run nor a ROS 2 bag"):
        read_log(tmp_path)


def test_bytes_that_are_no_text(tmp_path):
    (tmp_path / "boat.csv").write_bytes(b"time,a\n0,\xff\n")
    with pytest.raises(InputError, match="not UTF-8 text at byte 9"):
        read_log(tmp_path / "boat.csv")


def test_a_format_that_there_is_not(read):
    with pytest.raises(InputError, match="unknown log format 'cvs'; did you mean 'csv'"):
        read("time,a\n0,1\n", format_name="cvs")


def test_a_compressed_log(tmp_path):
    (tmp_path / "boat.csv.gz").write_bytes(gzip.compress(b"time,a\n0,1\n"))
    with pytest.raises(InputError, match=r"boat\.csv\.gz: is compressed \(gzip\)"):
        read_log(tmp_path / "boat.csv.gz")
