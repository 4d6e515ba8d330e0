"""The package's face: what it exports, what its import brings, and its types."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import seatrial
from tests.kit import needs_kits

HEAVY = ("casadi", "fmpy", "numpy", "pandas", "pint", "plotly", "pydantic", "scipy", "typer")


@needs_kits("batch", "campaigns")
def test_importing_brings_nothing_heavy() -> None:
    program = (
        "import json, sys, seatrial\nfrom seatrial import *\nprint(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    modules = json.loads(done.stdout)
    assert "seatrial.api.simulation" in modules
    assert not [name for name in modules if name.split(".")[0] in HEAVY]


@needs_kits("batch", "campaigns")
def test_what_is_exported_is_there_and_documented() -> None:
    assert set(seatrial.__all__) <= set(dir(seatrial))
    for name in seatrial.__all__:
        assert getattr(seatrial, name).__doc__
    with pytest.raises(AttributeError, match="no attribute 'Simulatoin'"):
        getattr(seatrial, "Simulatoin")  # noqa: B009


@pytest.mark.long
@pytest.mark.interop
def test_a_caller_of_the_api_is_type_checked(tmp_path: Path) -> None:
    """By what is installed: a wheel has ``py.typed`` beside the modules."""
    (tmp_path / "caller.py").write_text(
        "import seatrial\n"
        'with seatrial.Simulation("landing") as sim:\n'
        '    reveal_type(sim.record("vehicle.hull.*").signals["vehicle.hull.position"].unit)\n'
        '    sim.step("1 s")\n'
        'reveal_type(seatrial.run_trial("x").verdicts[0].worst)\n'
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run(
        [*command, "caller.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert 'Revealed type is "str"' in done.stdout
    assert 'Revealed type is "float | None"' in done.stdout
    assert 'caller.py:4: error: Argument 1 to "step"' in done.stdout
    assert "Found 1 error in 1 file" in done.stdout
