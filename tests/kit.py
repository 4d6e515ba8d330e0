"""Tests of the core that use a kit: skipped where the kit is not here."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.fmi.components.index import component_class, components
from seatrial.model.component import Component
from seatrial.shipped import available

OF_PROFILES = ("arduino", "ardupilot", "can", "gprs", "mavlink", "nmea", "px4", "ros2", "videoray")
"""Kits whose links stand in the profiles of shipped vehicles."""

_KITS = Path(__file__).parents[1] / "src/seatrial_kits"


def needs_kits(*names: str) -> pytest.MarkDecorator:
    """Return a mark that skips a test unless these kits are in the repository."""
    lacking = [name for name in names if not (_KITS / name).is_dir()]
    return pytest.mark.skipif(bool(lacking), reason=f"no kit {', '.join(lacking)}")


def classes(*names: str) -> tuple[type[Component], ...]:
    """Return the classes of these components, without those of kits that are not here."""
    there = components().names()
    return tuple(component_class(name) for name in names if name in there)


def vehicles(*names: str) -> list[str]:
    """Return these vehicles, without those of kits that are not here."""
    there = available("vehicles")
    return [name for name in names if name in there]
