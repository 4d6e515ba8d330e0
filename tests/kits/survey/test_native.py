"""Native FMUs in ``seatrial fmu survey``: the runs of FMPy, bit by bit."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.fmi.components.source import named_sources
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.survey.surveying import fmus_in, survey


@pytest.mark.slow
@pytest.mark.parametrize(("name", "version"), [("servo", 2), ("gnss", 3)])
def test_native_fmus_agree_with_fmpy(name: str, version: int, tmp_path: Path) -> None:
    platforms = ["linux64"]
    build_native_fmu(named_sources()[name], tmp_path / "it.fmu", platforms, None, version=version)
    (one,) = survey(fmus_in(tmp_path), 120.0)
    assert (one.status, one.ways) == ("agrees", ("in Python", "in C", "isolated", "FMPy"))
    assert one.outputs
    assert all(apart.value == 0.0 for apart in one.differences.values()), one
