"""Files of panel codes: Capytaine's NetCDF, and WAMIT's .1 and .3 as many codes write them."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.physics.sea.numbers import Array

from .panels import TURNED, PanelTables, all_round

LARGEST = 256 * 2**20
"""Most bytes of a file."""
MOST_NUMBERS = 20_000_000
"""In the arrays of a dataset, unpacked."""
MOTIONS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
_FEWEST = 8
"""Frequencies that a memory is fitted to."""


def read_panels(path: Path, density: float, gravity: float, length: float = 1.0) -> PanelTables:
    """Return the tables of a hull, for water of ``density``, kg/m3.

    ``.nc`` is a dataset of Capytaine (exp(-i w t), z up, y to port, moments about its
    ``rotation_center``), from which forces go by density and ``gravity``, m/s2. ``.1`` is WAMIT's
    radiation, with ``.3`` of the same name beside it for the excitation (exp(i w t), z up, y to
    port), made dimensional by ``length``, its ULEN, m: A = density L^k A', B = density L^k w B',
    F = density gravity L^m F'. Raises InputError naming file and line.
    """
    readers = {".nc": _capytaine, ".1": _wamit}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: {unknown('kind of panel code file', path.suffix, readers)}")
    tables = reader(path, density, gravity, length)
    if len(tables.omega) < _FEWEST:
        raise InputError(
            f"{path}: {len(tables.omega)} frequencies of radiation above 0 and below infinity; at "
            f"least {_FEWEST} are needed"
        )
    arrays = (tables.added, tables.damping, tables.infinite, tables.excitation)
    if not all(np.isfinite(array).all() for array in arrays):
        raise InputError(f"{path}: values that are no numbers (NaN or infinite)")
    return tables


def _made(
    path: Path,
    radiation: dict[float, tuple[Array, Array]],
    waves: tuple[Array, Array, Any],
) -> PanelTables:
    """Return tables in the project's axes; ``radiation`` A, B by frequency, waves of exp(i w t)."""
    if math.inf not in radiation:
        raise InputError(
            f"{path}: no added mass at infinite frequency (period 0): the memory of radiated waves "
            "needs it"
        )
    omega = np.array(sorted(w for w in radiation if 0.0 < w < math.inf))
    flip = np.outer(TURNED, TURNED)
    wave_omega, beta, forces = waves
    try:
        chi, excitation = all_round(-beta, forces * TURNED[:, None, None])
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    order = np.argsort(wave_omega)
    return PanelTables(
        omega,
        np.array([radiation[w][0] * flip for w in omega]),
        np.array([radiation[w][1] * flip for w in omega]),
        radiation[math.inf][0] * flip,
        wave_omega[order],
        chi,
        excitation[:, order],
    )


# ---------------------------------------------------------------------- WAMIT


def _wamit(path: Path, density: float, gravity: float, length: float) -> PanelTables:
    radiation: dict[float, tuple[Array, Array]] = {}
    for where, (period, i, j, *values) in _rows(path, (4, 5)):
        w = _omega(period)
        row, column = _motion(i, where), _motion(j, where)
        scale = density * length ** (3 + (row > 2) + (column > 2))
        added, damping = radiation.setdefault(w, (np.zeros((6, 6)), np.zeros((6, 6))))
        added[row, column] = scale * values[0]
        if len(values) == 2 and 0.0 < w < math.inf:
            damping[row, column] = scale * w * values[1]
    beside = path.with_suffix(".3")
    found: dict[tuple[float, float], Array] = {}
    for where, (period, beta, i, _size, _phase, real, imaginary) in _rows(beside, (7,)):
        w = _omega(period)
        if not 0.0 < w < math.inf:
            continue
        motion = _motion(i, where)
        force = found.setdefault((w, beta), np.zeros(6, dtype=complex))
        force[motion] = density * gravity * length ** (2 + (motion > 2)) * (real + 1j * imaginary)
    omegas, betas = (sorted({key[n] for key in found}) for n in (0, 1))
    missing = [(w, b) for w in omegas for b in betas if (w, b) not in found]
    if missing or not found:
        which = f"{missing[0][1]:g} degrees at {missing[0][0]:.5g} rad/s" if missing else "all"
        raise InputError(f"{beside}: excitation is missing: {which}")
    forces = np.array([[found[w, b] for b in betas] for w in omegas]).transpose(2, 0, 1)
    return _made(path, radiation, (np.array(omegas), np.radians(betas), forces))


def _rows(path: Path, lengths: tuple[int, ...]) -> Iterator[tuple[str, list[float]]]:
    """Yield place and numbers of the lines of a table; a first line may be a title."""
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: larger than {LARGEST >> 20} MiB")
        text = path.read_text("ascii")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text of ASCII characters") from None
    for number, line in enumerate(text.splitlines(), 1):
        words, where = line.split(), f"{path}, line {number}"
        try:
            values = [float(word.replace("D", "E")) for word in words]
        except ValueError:
            if number == 1:
                continue
            raise InputError(f"{where}: {line.strip()[:60]!r} is no row of numbers") from None
        if values and len(values) not in lengths:
            raise InputError(
                f"{where}: {len(values)} numbers, {' or '.join(map(str, lengths))} are needed"
            )
        if values:
            yield where, values


def _omega(period: float) -> float:
    """Return the frequency of a period as WAMIT has it: 0 s is infinite, below 0 s zero."""
    if period < 0.0:
        return 0.0
    return math.tau / period if period > 0.0 else math.inf


def _motion(number: float, where: str) -> int:
    if number not in range(1, 7):
        raise InputError(f"{where}: motion {number:g}, 1 to 6 are those of one hull")
    return int(number) - 1


# ------------------------------------------------------------------ Capytaine


def _capytaine(path: Path, density: float, gravity: float, _length: float) -> PanelTables:
    try:
        xarray = importlib.import_module("xarray")
    except ImportError:
        raise InputError(
            f"{path}: needs xarray and h5netcdf: pip install 'seatrial[panels]'; Capytaine also "
            "writes WAMIT's .1 and .3"
        ) from None
    try:
        with xarray.open_dataset(path, engine=_engine(path), decode_times=False) as opened:
            _refuse_large(path, opened.variables.values())  # nothing of them is read so far
            data = opened.load()
    except InputError:
        raise
    except Exception as error:  # HDF5's errors come as they are
        raise InputError(f"{path}: not read as NetCDF: {error or type(error).__name__}") from None
    try:
        return _of_dataset(path, data, density, gravity)
    except (IndexError, TypeError, ValueError) as error:
        raise InputError(f"{path}: not as Capytaine writes it: {error}") from None
    except KeyError as error:
        raise InputError(f"{path}: Capytaine's {error.args[0]!r} is missing") from None


def _engine(path: Path) -> str:
    """Return what reads a file by its first bytes: NetCDF 4 is HDF5, NetCDF 3 is its own."""
    with path.open("rb") as file:
        begin = file.read(8)
    if begin.startswith(b"CDF"):
        return "scipy"
    if begin == b"\x89HDF\r\n\x1a\n":
        with importlib.import_module("h5py").File(path) as whole:
            whole.visititems(lambda *_: None)  # h5netcdf prints a traceback where an object is cut
        return "h5netcdf"
    raise InputError(f"{path}: not NetCDF: it begins with {begin!r}")


def _refuse_large(path: Path, variables: Iterable[Any]) -> None:
    """Raise InputError for a file whose arrays, packed or not, have too many numbers."""
    count = sum(variable.size for variable in variables)
    if count > MOST_NUMBERS:
        raise InputError(f"{path}: arrays of {count} numbers, at most {MOST_NUMBERS} are read")


def _of_dataset(path: Path, data: Any, density: float, gravity: float) -> PanelTables:
    data = data.squeeze()
    along = data["omega"].dims
    if along and along != ("omega",):
        data = data.swap_dims({along[0]: "omega"})
    for name in ("influenced_dof", "radiating_dof"):
        found = [str(dof) for dof in np.atleast_1d(data[name].values)]
        if sorted(found) != sorted(MOTIONS):
            raise InputError(f"{path}: {name} is {', '.join(found)}: {', '.join(MOTIONS)} needed")
    rest = set(data["added_mass"].dims) - {"omega", "influenced_dof", "radiating_dof"}
    if rest:
        raise InputError(f"{path}: more than one value of {', '.join(sorted(map(str, rest)))}")
    speed = data.get("forward_speed")
    if speed is not None and float(speed) != 0.0:
        raise InputError(f"{path}: forward_speed is {float(speed):g} m/s, tables at 0 are needed")
    dense = density / float(data["rho"])
    by_motion = {"influenced_dof": list(MOTIONS), "radiating_dof": list(MOTIONS)}
    order = ("omega", "influenced_dof", "radiating_dof")
    added, damping = (
        dense * data[name].sel(by_motion).transpose(*order).values
        for name in ("added_mass", "radiation_damping")
    )
    omega = data["omega"].values.astype(float)
    force = (
        data["excitation_force"]
        if "excitation_force" in data
        else (data["Froude_Krylov_force"] + data["diffraction_force"])
    )
    force = force.sel(influenced_dof=list(MOTIONS)).transpose(
        "complex", "influenced_dof", "omega", "wave_direction"
    )
    waves = (omega > 0.0) & (omega < math.inf)
    # Complex conjugate: from exp(-i w t) to exp(i w t).
    scale = dense * gravity / float(data["g"])
    forces = scale * (force.values[0] - 1j * force.values[1])[:, waves]
    radiation = {w: (added[n], np.nan_to_num(damping[n])) for n, w in enumerate(omega.tolist())}
    tables = _made(path, radiation, (omega[waves], data["wave_direction"].values, forces))
    center = data.get("rotation_center")
    if center is None:
        return tables
    x, y, z = np.asarray(center.values, dtype=float).tolist()
    return tables.moved(np.array([x, -y, -z]))
