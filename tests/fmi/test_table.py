"""Files of values over time: against NumPy's interpolation, and what is wrong with them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import TableSource, find_source
from seatrial.fmi.components.table_file import frozen_table
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.instance import Instance
from seatrial.fmi.loading.conformance import problems
from seatrial.fmi.loading.load import load_fmu, open_instance

CONOPS = """time,Alt [m],Mach,heatLoad,gear [integer],on_ground,phase
0,0,0.2,500,1,true,taxi
60,0,0.2,500,1,true,taxi
60,0,0.2,500,2,false,climb
110.5,8000,0.8,500,3,false,cruise
120,8000,0.81,250,3,false,cruise
"""
"""As the boundary conditions of OMSimulator's aircraft demonstrator: a jump at 60 s."""


def source(path: Path, content: str = CONOPS) -> TableSource:
    path.write_text(content, "utf-8")
    found = find_source(path.name, path.parent)
    assert isinstance(found, TableSource)
    return found


def played(instance: Instance, h: float, steps: int, **values: Any) -> dict[str, list[Any]]:
    """Return all outputs at the start and after each step."""
    names = [v.name for v in instance.variables.values() if v.causality == "output"]
    try:
        instance.set_start(values)
        instance.initialise(0.0, steps * h)
        instance.begin()
        read = instance.reader(names)
        rows = [read()]
        for k in range(steps):
            instance.step(k * h, h)
            rows.append(read())
        return dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
    finally:
        instance.free()


def in_process(table: TableSource) -> DirectInstance:
    return DirectInstance(table.component_class()("table"))


def test_real_columns_are_numpys_interpolation_others_are_held(tmp_path: Path) -> None:
    table = source(tmp_path / "in.csv")
    found = played(in_process(table), 0.5, 240)
    t = np.arange(241) * 0.5
    rows = [line.split(",") for line in CONOPS.splitlines()[1:]]
    times = [float(row[0]) for row in rows]
    for name, column in (("Alt", 1), ("Mach", 2), ("heatLoad", 3)):
        wanted = np.interp(t, times, [float(row[column]) for row in rows])
        # A difference of 8000 m at most, in doubles.
        assert found[name] == pytest.approx(wanted, rel=1e-14, abs=1e-12)
    last = np.searchsorted(times, t, side="right") - 1
    assert found["gear"] == [int(rows[i][4]) for i in last]
    assert found["on_ground"] == [rows[i][5] == "true" for i in last]
    assert found["phase"] == [rows[i][6] for i in last]
    assert found["gear"][119:121] == [1, 2]  # at 60 s the later row holds


def test_its_fmu_gives_the_same_and_keeps_the_standard(tmp_path: Path) -> None:
    table = source(tmp_path / "in.csv", CONOPS.replace("Mach", "x[1]").replace("heatLoad", "Env.q"))
    fmu = load_fmu(build_fmu(table, tmp_path / "table.fmu"))
    assert problems(fmu) == []
    assert fmu.variables["Alt"].unit == "m"
    assert fmu.variables["gear"].type is int
    assert played(open_instance(fmu, "it"), 0.5, 200) == played(in_process(table), 0.5, 200)


def test_parquet_and_csv_are_the_same(tmp_path: Path) -> None:
    rows = [line.split(",") for line in CONOPS.splitlines()[1:]]
    columns = list(zip(*rows, strict=True))
    fields = [
        pa.field("time_ns", pa.int64()),
        pa.field("Alt", pa.float32(), metadata={"unit": "m"}),
        pa.field("Mach", pa.float64()),
        pa.field("heatLoad", pa.float64(), metadata={"unit": "1"}),
        pa.field("gear", pa.int8()),
        pa.field("on_ground", pa.bool_()),
        pa.field("phase", pa.string()),
    ]
    values: list[Any] = [[round(float(t) * 1e9) for t in columns[0]]]
    values += [[float(x) for x in columns[i]] for i in (1, 2, 3)]
    values += [[int(x) for x in columns[4]], [x == "true" for x in columns[5]], list(columns[6])]
    arrays = [pa.array(v, f.type) for v, f in zip(values, fields, strict=True)]
    parquet.write_table(pa.table(arrays, schema=pa.schema(fields)), tmp_path / "in.parquet")
    (tmp_path / "in.csv").write_text(CONOPS)
    one, other = (json.loads(frozen_table(tmp_path / name)) for name in ("in.csv", "in.parquet"))
    assert one.pop("file") != other.pop("file")
    assert one == other


@pytest.mark.parametrize(
    "content",
    [
        "sep=,\ntime,a\n0,1\n1,2\n",
        '"sep=;"\n"time";"a"\n"0";"1"\n\n"1";"2"\n',
        "\ufeffTime [ms]\ta\r\n0\t1.0\r\n1000\t2e0\r\n",
        " a , t \n 1 , 0 \n 2 , 1 \n",
        "a [1],time_ns\n1,0\n2,1000000000\n",
        "a [-],time[s]\n+1,0\n2,1\n",
    ],
)
def test_ways_of_writing_the_same(content: str, tmp_path: Path) -> None:
    made = json.loads(frozen_table(_written(tmp_path, content)))
    assert made["times_ns"] == [0, 1_000_000_000]
    ((name, kind, _, how, values),) = made["columns"]
    assert (name, kind, how, values) == ("a", "real", "linear", [1.0, 2.0])


def test_headings_say_how_a_column_is_read(tmp_path: Path) -> None:
    content = "time,a [rad/s held],b [integer],c[boolean],x[1],x[2] [m],d [text]\n0,1,2,1,3,4,5\n"
    columns = json.loads(frozen_table(_written(tmp_path, content)))["columns"]
    assert columns == [
        ["a", "real", "rad/s", "held", [1.0]],
        ["b", "integer", "", "held", [2]],
        ["c", "boolean", "", "held", [True]],
        ["x[1]", "real", "", "linear", [3.0]],
        ["x[2]", "real", "m", "linear", [4.0]],
        ["d", "text", "", "held", ["5"]],
    ]


def test_beyond_its_rows_it_refuses_or_holds(tmp_path: Path) -> None:
    table = source(tmp_path / "in.csv", "time,a\n1,5\n2,7\n")
    with pytest.raises(
        SimulationError, match=r"t = 0.0 s is beyond the rows of in\.csv, from 1\.0"
    ):
        played(in_process(table), 0.5, 1)
    found = played(in_process(table), 0.5, 6, beyond="hold")
    assert found["a"] == [5.0, 5.0, 5.0, 6.0, 7.0, 7.0, 7.0]
    started = in_process(source(tmp_path / "in.csv", "time,a\n0,5\n1,7\n"))
    started.initialise(0.0, 2.0)
    started.begin()
    started.step(0.0, 1.0)
    assert started.reader(["a"])() == [7.0]
    started.step(1.0, 1.0)
    with pytest.raises(SimulationError, match=r't = 2\.0 s is beyond .* beyond = "hold"'):
        started.reader(["a"])()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", r"has no heading"),
        ("time,a\n", r"has no rows"),
        (
            "seconds,a\n0,1\n",
            r"no column of times \(time, t, time_ns\); the columns are seconds, a",
        ),
        ("time\n0\n", r"no column but that of times"),
        (
            "time,a\n0,1\n2,1\n1,2\n",
            r"line 4, column 'time': the time goes back from 2\.0 s to 1\.",
        ),
        ("time,a\n0,1\n\nx,2\n", r"line 4, column 'time': a finite number is needed, found 'x'"),
        (
            "time,a\n0,1\n1,\n",
            r"line 3, column 'a': a finite number is needed, found an empty cell",
        ),
        (
            "time,a\n0,\n1,2\n",
            r"line 2, column 'a': a finite number is needed, found an empty cell",
        ),
        ("time,a\n0,n/a\n1,2\n", r"line 2, column 'a': a finite number is needed, found 'n/a'"),
        ("time,a\n0,1\n1,two\n", r"line 3, column 'a': a finite number is needed, found 'two'"),
        ("time,a\n0,1\n1,nan\n", r"line 3, column 'a': a finite number is needed, found 'nan'"),
        ("time,a\n0,1\n1,1_0\n", r"found '1_0'"),
        ("time;a\n0;0,5\n", r"line 2, column 'a': a finite number is needed, found '0,5'"),
        ("time,a\n0,1\n1\n", r"line 3: 1 values, the heading has 2"),
        ("time,a\n0,1\n1,2,3\n", r"line 3: 3 values, the heading has 2"),
        ("time,a\n0,true\n1,2\n", r"line 3, column 'a': true or false is needed, found '2'"),
        ("time,a [integer]\n0,1\n1,1.5\n", r"line 3, column 'a': an integer of 32 bits .* '1\.5'"),
        ("time,a [integer]\n0,3000000000\n", r"an integer of 32 bits is needed"),
        (
            "time,a [parsec/h/x]\n0,1\n",
            r"line 1, column 'a': .*real, integer, boolean, text, held can",
        ),
        ("time [m],a\n0,1\n", r"line 1, column 'time': unit 'm' cannot be converted to 's'"),
        ("time,a,a\n0,1,2\n", r"line 1: the column 'a' occurs twice"),
        ("time,,a\n0,1,2\n", r"line 1: an output cannot be called ''"),
        ("time,step\n0,1\n", r"an output cannot be called 'step'; rename"),
        ("time,beyond\n0,1\n", r"an output cannot be called 'beyond'"),
        ('time,a\n0,"1\n', r"not CSV"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_line(
    content: str, message: str, tmp_path: Path
) -> None:
    path = _written(tmp_path, content)
    with pytest.raises(InputError, match=message) as caught:
        frozen_table(path)
    assert str(path) in str(caught.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no table .*gone\.csv"):
        find_source("gone.csv", tmp_path)
    (tmp_path / "a.csv").write_bytes(b"time,a\n0,\xff\n")
    with pytest.raises(InputError, match=r"a\.csv: not UTF-8 text at byte 9"):
        find_source("a.csv", tmp_path)
    (tmp_path / "a.parquet").write_bytes(b"PAR1 is not all")
    with pytest.raises(InputError, match=r"a\.parquet: not Parquet"):
        find_source("a.parquet", tmp_path)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (pa.array([1.0, None]), r"row 2, column 'a': a finite number is needed, found an empty"),
        (pa.array([1, 2**40]), r"row 2, column 'a': an integer of 32 bits"),
        (
            pa.array([b"1", b"2"]),
            r"column 'a': numbers, switches or texts are needed, found binary",
        ),
        (pa.array([[1], [2]]), r"column 'a': numbers, switches or texts are needed, found list"),
    ],
)
def test_columns_of_parquet_that_are_refused(values: Any, message: str, tmp_path: Path) -> None:
    parquet.write_table(pa.table({"time": [0.0, 1.0], "a": values}), tmp_path / "x.parquet")
    with pytest.raises(InputError, match=message):
        frozen_table(tmp_path / "x.parquet")


def _written(folder: Path, content: str) -> Path:
    path = folder / "in.csv"
    path.write_text(content, "utf-8")
    return path
