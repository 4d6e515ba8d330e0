"""Reference data of the sea models, as arrays by column."""

import json
from pathlib import Path

import numpy as np

REFERENCE = Path(__file__).resolve().parents[1] / "reference"


def table(name):
    """Return the columns of ``sea_NAME.csv`` by name; columns of text are arrays of text."""
    return np.genfromtxt(
        REFERENCE / f"sea_{name}.csv", delimiter=",", names=True, dtype=None, encoding="utf-8"
    )


def content(name):
    """Return what ``sea_NAME.json`` says."""
    return json.loads((REFERENCE / f"sea_{name}.json").read_text("utf-8"))
