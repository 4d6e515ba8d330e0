"""Policies written into a folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.model.component import Component
from seatrial_kits.learning.network_file import read_network

PLAIN = """network = "net.npz"
period = "100 ms"
[inputs]
x = { unit = "m", axes = ["a", "b", "c"] }
[outputs]
y = { unit = "N", axes = ["p", "q"] }
"""
LAYERS = {
    "W0": [[1.0, 2.0, 3.0], [0.5, 0.0, -1.0]],
    "b0": [0.25, -0.5],
    "activations": ["identity"],
}


def write(folder: Path, text: str = PLAIN, arrays: Mapping[str, Any] | None = None) -> Path:
    """Return a policy's file with its network."""
    np.savez(folder / "net.npz", **{k: np.array(v) for k, v in (arrays or LAYERS).items()})
    (folder / "policy.toml").write_text(text, "utf-8")
    return folder / "policy.toml"


def source(path: Path) -> ComponentSource:
    found = find_source(path.name, path.parent)
    assert isinstance(found, ComponentSource)
    return found


def started(path: Path) -> Component:
    """Return a policy that has started."""
    component = source(path).component_class()("policy")
    component.setup(0.0)
    component.initialise()
    component.begin()
    return component


def ports(inputs: int, outputs: int, period: str = 'period = "100 ms"\n') -> str:
    """Return the text of a policy with that many inputs and outputs."""
    axes = [json.dumps([f"a{i}" for i in range(size)]) for size in (inputs, outputs)]
    return (
        f'network = "net.npz"\n{period}'
        f'[inputs]\nx = {{ unit = "m", axes = {axes[0]} }}\n'
        f'[outputs]\ny = {{ unit = "N", axes = {axes[1]} }}\n'
    )


def network(sizes: Sequence[int], activations: Sequence[str], seed: int) -> dict[str, Any]:
    """Return arrays of a random network."""
    random = np.random.default_rng(seed)
    found: dict[str, Any] = {"activations": list(activations)}
    for number, (columns, rows) in enumerate(pairwise(sizes)):
        found[f"W{number}"] = random.normal(size=(rows, columns))
        found[f"b{number}"] = random.normal(size=rows)
    return found


def read_or_refused(path: Path) -> None:
    """Read a network; what is wrong with it is said of its file."""
    why = ""
    try:
        read_network(path, None)
    except InputError as error:
        why = str(error)
    assert why.startswith(str(path) if why else "")
