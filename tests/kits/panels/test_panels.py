"""Files of panel codes against each other and against another mesh, and mistakes in them."""

import math
import re

import numpy as np
import pytest
import xarray

from seatrial.errors import InputError
from seatrial_kits.panels.panel_files import read_panels
from tests.sea.references import REFERENCE, table

from .test_memory import panels

NETCDF, WAMIT = (REFERENCE / f"barge_capytaine.{ending}" for ending in ("nc", "1"))
MOTIONS = ("surge", "sway", "heave", "roll", "pitch", "yaw")


@pytest.fixture(scope="module")
def barge():
    return read_panels(NETCDF, 1025.0, 9.81)


def test_netcdf_and_wamit_say_the_same(barge):
    # Capytaine wrote both, with 7 digits; A and B of its NetCDF are not quite symmetric.
    other = read_panels(WAMIT, 1025.0, 9.81)
    for name in ("omega", "added", "damping", "infinite", "wave_omega", "chi", "excitation"):
        here, there = getattr(barge, name), getattr(other, name)
        if name in ("added", "damping", "infinite"):
            here, there = (m + np.swapaxes(m, -1, -2) for m in (here, there))
        assert here.shape == there.shape
        assert np.abs(here - there).max() < 1e-6 * np.abs(here).max()


def test_excitation_is_that_of_a_finer_mesh(barge):
    rows, seen = table("rao_barge_T020"), 0
    largest = {name: rows[f"F_{name}_amp"].max() for name in MOTIONS}
    for row in rows:
        i = np.argmin(abs(barge.wave_omega - row["omega"]))
        j = np.argmin(abs(barge.chi - math.radians(row["direction_deg"])))
        if abs(barge.wave_omega[i] - row["omega"]) > 1e-6 or row["omega"] > 6.0:
            continue
        seen += 1
        for n, name in enumerate(MOTIONS):
            wanted = row[f"F_{name}_amp"] * np.exp(1j * math.radians(row[f"F_{name}_deg"]))
            # The spec allows 2 %; moments of roll, small differences of large ones, need 4.
            allowed = 0.04 if name == "roll" else 0.02
            assert abs(barge.excitation[n, i, j] - wanted) < allowed * largest[name]
    assert seen > 15


def test_radiation_is_that_of_a_finer_mesh(barge):
    w, added, damping, infinite = panels("barge_T020")
    both = [(i, k) for i, o in enumerate(barge.omega) for k, p in enumerate(w) if abs(o - p) < 1e-6]
    both = [(i, k) for i, k in both if w[k] <= 6.0]
    assert len(both) == 4
    for mine, its in ((barge.added, added), (barge.damping, damping)):
        for n in range(6):
            largest = np.abs(its[:, n, n]).max()
            off = [abs(mine[i, n, n] - its[k, n, n]) for i, k in both]
            assert max(off) < 0.05 * largest
    assert barge.infinite[2, 2] == pytest.approx(infinite[2, 2], rel=0.03)


def test_a_rotation_center_is_taken_out(tmp_path, barge):
    xarray = pytest.importorskip("xarray")
    data = xarray.open_dataset(NETCDF).load()
    data.close()
    # The same hull by motions about (0.3, 0, -0.1), z up: a turn about it moves the origin too.
    turned = np.eye(6)
    turned[:3, 3:] = [[0.0, 0.1, 0.0], [-0.1, 0.0, -0.3], [0.0, 0.3, 0.0]]
    turned[:3, 3:] *= -1.0
    inverse = np.linalg.inv(turned)
    for name in ("added_mass", "radiation_damping"):
        old = data[name].transpose("omega", "influenced_dof", "radiating_dof")
        data[name] = old.copy(data=inverse.T @ old.values @ inverse)
    old = data["excitation_force"].transpose("complex", "omega", "wave_direction", "influenced_dof")
    data["excitation_force"] = old.copy(data=old.values @ inverse)
    data["rotation_center"] = ("space_coordinate", [0.3, 0.0, -0.1])
    data.to_netcdf(tmp_path / "moved.nc", engine="h5netcdf")
    found = read_panels(tmp_path / "moved.nc", 1025.0, 9.81)
    for name in ("added", "damping", "infinite", "excitation"):
        wanted = getattr(barge, name)
        assert np.abs(getattr(found, name) - wanted).max() < 1e-9 * np.abs(wanted).max()


def test_other_water_and_another_length(barge):
    fresh = read_panels(NETCDF, 1000.0, 9.81)
    np.testing.assert_allclose(fresh.excitation, barge.excitation / 1.025, rtol=1e-12)
    twice = read_panels(WAMIT, 1025.0, 9.81, length=2.0)
    once = read_panels(WAMIT, 1025.0, 9.81)
    np.testing.assert_allclose(twice.added[:, 2, 2], 8 * once.added[:, 2, 2], rtol=1e-12)
    np.testing.assert_allclose(twice.added[:, 4, 4], 32 * once.added[:, 4, 4], rtol=1e-12)
    np.testing.assert_allclose(twice.excitation[3:], 8 * once.excitation[3:], rtol=1e-12)


def test_moving_there_and_back(barge):
    there = barge.moved(np.array([0.4, 0.0, -0.2]))
    back = there.moved(np.array([-0.4, 0.0, 0.2]))
    np.testing.assert_allclose(back.added, barge.added, atol=1e-9)
    # Heave at a place ahead of the other pitches too: A_53 = A_35 = - x A_33.
    ahead = barge.moved(np.array([0.4, 0.0, 0.0])).added
    np.testing.assert_allclose(
        ahead[:, 2, 4], barge.added[:, 2, 4] - 0.4 * barge.added[:, 2, 2], rtol=1e-9
    )


LINES = WAMIT.read_text("ascii").splitlines(keepends=True)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda one: [x for x in one if not x.startswith("0.0")], "infinite frequency (period 0)"),
        (lambda one: ["one two\n", *one[:40], "what\n"], "line 42: 'what' is no row of numbers"),
        (lambda one: [*one, "1.0 7 1 0.2 0.3\n"], "motion 7, 1 to 6"),
        (lambda one: [*one, "1.0 1 1 0.2 0.3 0.4\n"], "6 numbers, 4 or 5 are needed"),
        (lambda one: one[:200], "at least 8"),
        (lambda one: [*one, "1.0 1 1 nan 0.3\n"], "no numbers"),
    ],
)
def test_mistakes_in_wamit_files(tmp_path, change, message):
    (tmp_path / "hull.1").write_text("".join(change(LINES)), "ascii")
    (tmp_path / "hull.3").write_text(WAMIT.with_suffix(".3").read_text("ascii"), "ascii")
    with pytest.raises(InputError, match=re.escape(message)) as found:
        read_panels(tmp_path / "hull.1", 1025.0, 9.81)
    assert "hull." in str(found.value)


def test_excitation_that_is_not_there(tmp_path):
    (tmp_path / "hull.1").write_text("".join(LINES), "ascii")
    with pytest.raises(InputError, match=r"hull\.3: No such file"):
        read_panels(tmp_path / "hull.1", 1025.0, 9.81)
    rows = WAMIT.with_suffix(".3").read_text("ascii").splitlines(keepends=True)
    (tmp_path / "hull.3").write_text("".join(rows[6:]), "ascii")
    with pytest.raises(InputError, match="excitation is missing: 0 degrees"):
        read_panels(tmp_path / "hull.1", 1025.0, 9.81)
    few = [row for row in rows if row.split()[1] in ("0.000000", "180.000000")]
    (tmp_path / "hull.3").write_text("".join(few), "ascii")
    with pytest.raises(InputError, match="more than 45 degrees apart: 0, 180"):
        read_panels(tmp_path / "hull.1", 1025.0, 9.81)


@pytest.mark.parametrize(("name", "message"), [("hull.hst", "kind of"), ("hull.nc", "NetCDF")])
def test_files_of_no_panel_code(tmp_path, name, message):
    (tmp_path / name).write_text("nothing", "ascii")
    with pytest.raises(InputError, match=message):
        read_panels(tmp_path / name, 1025.0, 9.81)


def test_a_small_file_with_large_arrays_is_refused_before_they_are_unpacked(tmp_path):
    """Zeros are packed to a thousandth; what is declared counts, and none of it is read."""
    data = xarray.Dataset({"a": ("x", np.zeros(21_000_000, "u1"))})
    packed = {"a": {"zlib": True, "complevel": 9}}
    data.to_netcdf(tmp_path / "hull.nc", engine="h5netcdf", encoding=packed)
    assert (tmp_path / "hull.nc").stat().st_size < 200_000
    with pytest.raises(InputError, match="arrays of 21000000 numbers, at most 20000000 are read"):
        read_panels(tmp_path / "hull.nc", 1025.0, 9.81)


@pytest.mark.parametrize("content", [b"", b"CDF\x01", b"\x89HDF\r\n\x1a\n" + bytes(99), b"{}"])
def test_what_is_no_netcdf(content, tmp_path):
    (tmp_path / "hull.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"hull\.nc: not (read as )?NetCDF"):
        read_panels(tmp_path / "hull.nc", 1025.0, 9.81)
