"""Files of depths: ESRI ASCII grids, tables, and what is wrong in them."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.model.component import Component
from seatrial_kits.underwater.seabed.grid import read_grid
from seatrial_kits.underwater.seabed.parameters import OverSeabed

ASC = """ncols 3
nrows 2
xllcorner 100
yllcorner -10
cellsize 20
NODATA_value -9999
-1 -2 -3
-4 -5 -6
"""
CSV = "north,east,depth\n0,0,5\n0,10,6\n20,0,7\n20,10,8\n"


def test_an_esri_grid_has_its_first_row_in_the_north(write):
    grid = read_grid(write("bay.asc", ASC))
    assert grid.north.tolist() == [0.0, 20.0]
    assert grid.east.tolist() == [110.0, 130.0, 150.0]
    assert grid.depth.tolist() == [[4.0, 5.0, 6.0], [1.0, 2.0, 3.0]]


def test_corner_and_centre_of_the_first_cell_say_the_same(write):
    centre = ASC.replace("xllcorner 100", "XLLCENTER 110").replace("yllcorner -10", "yllcenter 0")
    one, other = (read_grid(write(name, t)) for name, t in (("a.asc", ASC), ("b.ASC", centre)))
    assert np.array_equal(one.north, other.north)
    assert np.array_equal(one.east, other.east)


def test_numpy_reads_the_same_depths(write):
    path = write("bay.asc", ASC)
    assert np.array_equal(-np.loadtxt(path, skiprows=6)[::-1], read_grid(path).depth)


def test_a_table_may_be_in_any_order(write):
    grid = read_grid(write("bay.csv", "north,east,depth\n20,10,8\n0,0,5\n\n20,0,7\n0,10,6\n"))
    same = read_grid(write("same.csv", CSV))
    assert np.array_equal(grid.depth, same.depth)
    assert grid.depth_at(10.0, 5.0) == 6.5


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.tif", "", r"a\.tif: unknown kind of grid file '\.tif'.*known: \.asc, \.csv"),
        ("a.asc", ASC.replace("-5", "-9999"), r"a\.asc, line 8: a point without data"),
        ("a.asc", ASC.replace("-5", "deep"), r"a\.asc, line 8: 'deep' is not a number"),
        ("a.asc", ASC.replace("-5", "nan"), r"a\.asc, line 8: 'nan' is not a number"),
        ("a.asc", ASC.replace("-5 ", ""), r"a\.asc: 5 values, 2 rows of 3 are needed"),
        ("a.asc", ASC.replace("cellsize 20", "cellsize 0"), r"cellsize is 0\.0, above 0 m"),
        ("a.asc", ASC.replace("ncols 3", "ncols 2.5"), r"ncols is 2\.5, a whole number from 2"),
        ("a.asc", ASC.replace("ncols 3\n", ""), r"ncols is None"),
        ("a.asc", ASC.replace("xllcorner 100\n", ""), r"one of xllcorner and xllcenter"),
        ("a.asc", ASC.replace("cellsize", "cell"), r"line 5: 'cell 20' is none of ncols"),
        ("a.asc", ASC.replace("cellsize 20", "cellsize 1e-300"), r"too small beside the corner"),
        ("a.csv", CSV.replace("east", "west"), r"line 1: 'north,west,depth', the head must be"),
        ("a.csv", CSV.replace("20,10,8\n", ""), r"a\.csv: no depth at north 20\.0, east 10\.0"),
        ("a.csv", CSV + "0,0,1\n", r"line 6: a second depth at north 0\.0, east 0\.0"),
        ("a.csv", CSV + "0,0\n", r"line 6: 2 values, north, east, depth are needed"),
        ("a.csv", "north,east,depth\n1,2,3\n", r"two norths and two easts"),
        ("a.csv", "", r"line 1: '', the head must be"),
        ("a.csv", "nörth", r"not a text of ASCII"),
    ],
)  # fmt: skip
def test_mistakes_are_named(write, name, text, message):
    with pytest.raises(InputError, match=message):
        read_grid(write(name, text))


def test_no_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.asc: No such file"):
        read_grid(tmp_path / "none.asc")


class Floor(OverSeabed, Component):
    """Has a seabed and nothing else."""


def floor(**values):
    component = Floor("floor")
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    return component.scene()


def test_parameters_make_a_seabed(write):
    assert floor().bed is None
    assert floor(seabed_depth=12.0, seabed_slope=0.1).bed.depth_at(1.0, 0.0) > 12.0
    path = write("bay.csv", CSV)
    assert floor(seabed_file=str(path)).bed.depth_at(0.0, 0.0) == 5.0
    path.write_text(CSV.replace("0,0,5", "0,0,99"))
    assert floor(seabed_file=str(path)).bed.depth_at(0.0, 0.0) == 99.0
    assert len(floor(obstacles="sphere 1 2 3 4").obstacles) == 1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"seabed_slope": 0.1}, "floor: seabed_slope needs a seabed_depth"),
        ({"seabed_depth": 5.0, "seabed_file": "x.asc"}, "seabed_depth and seabed_slope must be 0"),
        ({"seabed_file": "absent.asc"}, "absent.asc: No such file"),
        ({"obstacles": "ball 1"}, "obstacle 'ball'"),
    ],
)
def test_a_seabed_that_cannot_be_is_refused_at_the_start(values, message):
    with pytest.raises(InputError, match=message):
        floor(**values)
