"""Tests of the core that use a kit: skipped where the kit is not here."""

from __future__ import annotations

from pathlib import Path

import pytest

OF_PROFILES = ("arduino", "ardupilot", "can", "gprs", "mavlink", "nmea", "px4", "ros2", "videoray")
"""Kits whose links stand in the profiles of shipped vehicles."""

_KITS = Path(__file__).parents[1] / "src/seatrial_kits"


def needs_kits(*names: str) -> pytest.MarkDecorator:
    """Return a mark that skips a test unless these kits are in the repository."""
    lacking = [name for name in names if not (_KITS / name).is_dir()]
    return pytest.mark.skipif(bool(lacking), reason=f"no kit {', '.join(lacking)}")
