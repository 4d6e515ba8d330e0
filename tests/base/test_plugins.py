"""Registries of names, with packages that add to them."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.plugins import Registry
from tests.packages import installed

REGISTRY = Registry("seatrial.tests", "shape", {"round": "math:tau", "square": "math:sqrt"})


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a function that installs packages with names of shapes."""

    def install(**targets: dict[str, str]) -> None:
        for package, names in targets.items():
            folder = installed(tmp_path / package, package, {"seatrial.tests": names})
            monkeypatch.syspath_prepend(folder)

    return install


def test_shipped_and_added_names_in_that_order(packages) -> None:
    packages(zeta={"flat": "math:pi", "bent": "math:inf"}, alpha={"curved": "math:e"})
    assert REGISTRY.names() == ["round", "square", "bent", "curved", "flat"]


def test_a_name_gives_its_object(packages) -> None:
    import math

    packages(alpha={"flat": "math:pi"})
    assert REGISTRY.load("round") == math.tau
    assert REGISTRY.load("flat") == math.pi


def test_an_unknown_name_has_near_misses_among_added_names(packages) -> None:
    packages(alpha={"curved": "math:pi"})
    with pytest.raises(InputError, match=r"unknown shape 'curve'; did you mean 'curved'\?"):
        REGISTRY.target("curve")


def test_a_shipped_name_is_not_replaced(packages) -> None:
    packages(alpha={"round": "math:pi", "flat": "math:e"})
    both = r"shape 'round' comes from seatrial itself \(math:tau\) and from the package alpha \(math:pi\)"
    with pytest.raises(InputError, match=both):
        REGISTRY.load("round")
    assert REGISTRY.target("square") == "math:sqrt"
    assert REGISTRY.target("flat") == "math:e"


def test_two_packages_with_one_name_are_named(packages) -> None:
    packages(beta={"flat": "math:pi"}, alpha={"flat": "math:pi"})
    with pytest.raises(
        InputError, match=r"the package alpha \(math:pi\) and from the package beta"
    ):
        REGISTRY.load("flat")


@pytest.mark.parametrize(
    ("target", "cause"),
    [
        ("no_such_module_anywhere:Shape", "ModuleNotFoundError: No module named 'no_such_module"),
        ("math:no_such_name", "AttributeError"),
    ],
)
def test_what_cannot_be_imported_is_named(packages, target: str, cause: str) -> None:
    packages(alpha={"flat": target})
    with pytest.raises(InputError, match=f"shape 'flat': cannot load '{target}' .*{cause}"):
        REGISTRY.load("flat")
