"""Flags that every FMU gets: an FMU in C that shows those of its instantiation as an output."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import changed, read, started, variant

LOGGING, EARLY, EVENTS, REQUIRED, UPDATES = 1, 2, 4, 8, 16


@pytest.mark.sampled(2)
@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize(
    ("has_events", "flags"), [(True, LOGGING | EARLY | EVENTS), (False, LOGGING | EARLY)]
)
def test_fmi_3_gets_event_mode_if_it_has_that_and_no_intermediate_updates(
    native_fmu: Callable[[str], Path], tmp_path: Path, has_events: bool, flags: int, isolated: bool
) -> None:
    path = variant(native_fmu("fmi3"), tmp_path / "flags.fmu", "SHOWS_FLAGS")
    if not has_events:
        path = changed(path, tmp_path / "without.fmu", ('hasEventMode="true"', ""))
    fmu = load_fmu(path)
    instance = IsolatedInstance(fmu, "it", 30.0) if isolated else open_instance(fmu, "it")
    assert read(started(instance), "x") == [float(flags)]
    instance.free()


def test_fmi_2_gets_logging(native_fmu: Callable[[str], Path], tmp_path: Path) -> None:
    path = variant(native_fmu("fmi2"), tmp_path / "flags.fmu", "SHOWS_FLAGS")
    instance = open_instance(load_fmu(path), "it")
    assert read(started(instance), "x") == [float(LOGGING)]
    instance.free()
