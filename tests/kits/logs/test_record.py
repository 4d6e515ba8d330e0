"""Columns of records: of the types that the manifest says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial_kits.logs.record import columns


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("box.b", np.array([1.0, np.nan])),
        ("box.b", ["one", "two"]),
        ("box.b.c.d", np.array([1.0, 2.5])),
        ("box.e.f.g", np.array([0.0, 2.0])),
        ("box.raw", ["AP8=", "?"]),
    ],
)
def test_a_signal_of_another_type_is_named(foreign: Run, name: str, values) -> None:
    with pytest.raises(InputError, match=f"{name} is not of the type"):
        columns(replace(foreign, signals={name: values}))
