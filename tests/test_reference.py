"""The reference of the library: pages below docs/reference/api cover what is public."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from seatrial.fmi.components.index import components, shipped_names

API = Path(__file__).resolve().parents[1] / "docs" / "reference" / "api"
BLOCK = re.compile(r"^::: ([\w.]+)((?:\n    .*)*)", re.MULTILINE)
DOCUMENTED = {
    name: "show_submodules: true" in options
    for page in API.glob("*.md")
    for name, options in BLOCK.findall(page.read_text("utf-8"))
}
"""Modules by name, and whether those below them are shown too."""


def is_documented(module: str) -> bool:
    return module in DOCUMENTED or any(
        deep and module.startswith(f"{name}.") for name, deep in DOCUMENTED.items()
    )


@pytest.mark.parametrize(
    "module",
    [
        "seatrial", "seatrial.errors", "seatrial.gym", "seatrial.links.endpoints.endpoint",
        "seatrial.model.component", "seatrial.model.plant", "seatrial.model.sampled",
        "seatrial.model.terminals", "seatrial.model.terms", "seatrial.physics.sea.spectra",
        "seatrial.sim.algorithms", "seatrial.testing.plugin",
    ],
)  # fmt: skip
def test_what_users_import_is_in_the_reference(module: str) -> None:
    assert is_documented(module)


def test_every_component_is_in_the_reference() -> None:
    found = {name: components().target(name).partition(":")[0] for name in shipped_names()}
    assert {name: module for name, module in found.items() if not is_documented(module)} == {}
