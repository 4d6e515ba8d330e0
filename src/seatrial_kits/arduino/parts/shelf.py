"""The parts that there are by name: shipped ones, those of packages, and files by their path."""

from __future__ import annotations

import importlib.util
from functools import cache
from pathlib import Path

from seatrial.errors import InputError, unknown

from ..part import Part
from .as5600 import As5600
from .bno055 import Bno055
from .cmps12 import Cmps12
from .ds18b20 import Ds18b20
from .espnow import EspNow
from .hcsr04 import HcSr04
from .hmc5883l import Hmc5883l
from .lsm303 import Lsm303Accelerometer, Lsm303Magnetometer
from .ma3 import Ma3
from .mpu6050 import Mpu6050
from .ms5837 import Ms5837
from .nrf24 import Nrf24
from .pca9685 import Pca9685
from .pixy import Pixy
from .qmc5883l import Qmc5883l
from .rfm95 import Rfm95
from .sd_card import SdCard

GROUP = "seatrial.arduino_parts"
"""Entry-point group that packages add parts to."""
_FILE = ".py:"

SHELF: dict[str, type[Part]] = {
    "as5600": As5600,
    "bno055": Bno055,
    "cmps12": Cmps12,
    "ds18b20": Ds18b20,
    "espnow": EspNow,
    "hcsr04": HcSr04,
    "hmc5883l": Hmc5883l,
    "lsm303_accelerometer": Lsm303Accelerometer,
    "lsm303_magnetometer": Lsm303Magnetometer,
    "ma3": Ma3,
    "mpu6050": Mpu6050,
    "ms5837": Ms5837,
    "nrf24": Nrf24,
    "pca9685": Pca9685,
    "pixy": Pixy,
    "qmc5883l": Qmc5883l,
    "rfm95": Rfm95,
    "sd_card": SdCard,
}


@cache
def _added() -> dict[str, str]:
    """Return ``module:Class`` of the parts that packages add, by name."""
    from importlib.metadata import entry_points

    return {point.name: point.value for point in entry_points(group=GROUP)}


def part_names() -> list[str]:
    """Return the names of all parts."""
    return sorted({*SHELF, *_added()})


def is_part(name: str) -> bool:
    """Return whether a name in ``wires`` is a part's, or a file's."""
    return _FILE in name or name in SHELF or name in _added()


def known_part(name: str) -> type[Part] | None:
    """Return a part by name; None for a file, which only a run reads."""
    return None if _FILE in name else part_class(name, Path())


def part_class(name: str, folder: Path) -> type[Part]:
    """Return a part by its name, or by ``FILE.py:Class``, from ``folder`` on.

    Raises InputError for one that is not there or is no `Part`.
    """
    if name in SHELF:
        return SHELF[name]
    if _FILE in name:
        return _of_file(name, folder)
    if name not in _added():
        raise InputError(f"wires: {unknown('part', name, part_names())}")
    from pkgutil import resolve_name

    try:
        found = resolve_name(_added()[name])
    except (ImportError, AttributeError) as error:
        raise InputError(f"wires: {name}: {_added()[name]} cannot be imported: {error}") from error
    return _checked(name, found)


def _of_file(text: str, folder: Path) -> type[Part]:
    written, _, name = text.rpartition(":")
    file = (folder / Path(written).expanduser()).resolve()
    if not file.is_file():
        raise InputError(f"wires: {text}: there is no file {file}")
    spec = importlib.util.spec_from_file_location(f"part_{file.stem}", file)
    assert spec is not None and spec.loader is not None  # noqa: PT018
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise InputError(f"wires: {file} does not run: {type(error).__name__}: {error}") from error
    if not hasattr(module, name):
        raise InputError(f"wires: {file} has no class {name!r}")
    return _checked(text, getattr(module, name))


def _checked(name: str, found: object) -> type[Part]:
    if not (isinstance(found, type) and issubclass(found, Part)):
        raise InputError(
            f"wires: {name} is {found!r}: a class of seatrial_kits.arduino.part is needed"
        )
    return found
