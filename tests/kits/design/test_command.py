"""``seatrial design`` as its user meets it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.command import seatrial


def test_it_prints_gains_and_leaves_a_page(tmp_path: Path) -> None:
    """The source's ship, derivative time -1.3427 L/U: stable below K = 0.0114200518 (Routh)."""
    done = seatrial(
        "design", "mariner", "--variant", "source", "--td", "-1.3427", "--out", "page", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert "stable for K < 0.0114200518" in done.stdout
    assert "0.70711" in done.stdout
    assert [path.name for path in (tmp_path / "page").iterdir()] == ["report.html"]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("hydrone",), "hydrone/vehicle.toml: a vehicle with a table 'manoeuvring-ship' is needed"),
        (("marinr",), "mariner"),
        (("mariner", "--damping", "2"), "damping ratio is 2.0, between 0 and 1"),
        (("mariner", "--variant", "cubed"), "cubic"),
        (("mariner", "--td", "fast"), "Invalid value for '--td'"),
    ],
)
def test_mistakes_are_named_and_leave_nothing(
    tmp_path: Path, arguments: tuple[str, ...], expected: str
) -> None:
    done = seatrial("design", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())
