"""All harnesses: their kept inputs, and a few that hypothesis makes; for long with Atheris."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

FOLDER = Path(__file__).parent
CORPUS = FOLDER / "corpus"
NAMES = sorted(path.stem.removeprefix("fuzz_") for path in FOLDER.glob("fuzz_*.py"))
KEPT = sorted(path for path in CORPUS.glob("*/*"))
SLOW = {"archives": 15, "panels": 15, "dronecan": 20, "run_folder": 10, "toml": 15}
"""Examples of harnesses that write files and draw pages."""


def harness(name: str) -> Callable[[bytes], None]:
    try:
        one: Callable[[bytes], None] = import_module(f"{__package__}.fuzz_{name}").one
    except ModuleNotFoundError as error:
        if str(error.name).startswith("seatrial_kits."):
            pytest.skip(str(error))
        raise
    return one


@pytest.mark.parametrize("path", KEPT, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_kept_inputs(path: Path) -> None:
    harness(path.parent.name)(path.read_bytes())


def test_the_corpus_is_small_and_every_harness_has_one() -> None:
    assert {path.parent.name for path in KEPT} == set(NAMES)
    assert sum(path.stat().st_size for path in KEPT) < 200_000


@st.composite
def inputs(draw: st.DrawFn, name: str) -> bytes:
    """Return bytes: any, or a kept input with a few of them cut out, replaced or put in."""
    seeds = [path.read_bytes() for path in KEPT if path.parent.name == name]
    data = draw(st.one_of(st.binary(max_size=200), st.sampled_from(seeds)))
    for _ in range(draw(st.integers(0, 4))):
        begin = draw(st.integers(0, len(data)))
        end = min(len(data), begin + draw(st.integers(0, 8)))
        data = data[:begin] + draw(st.binary(max_size=8)) + data[end:]
    return data


@pytest.mark.parametrize("name", NAMES)
def test_made_inputs(name: str) -> None:
    one = harness(name)

    @settings(
        max_examples=SLOW.get(name, 40),
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(inputs(name))
    def made(data: bytes) -> None:
        one(data)

    made()


@pytest.mark.long
@pytest.mark.skipif(importlib.util.find_spec("atheris") is None, reason="no Atheris here")
@pytest.mark.parametrize("name", NAMES)
def test_for_long(name: str, tmp_path: Path) -> None:
    """10^6 executions or half an hour; the last lines of libFuzzer say what was covered."""
    limits = ["-runs=1000000", "-max_total_time=1800", "-rss_limit_mb=4096", "-timeout=60"]
    limits.append(f"-artifact_prefix={tmp_path}/")
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", name, *limits, str(tmp_path)],
        cwd=FOLDER.parents[1],
        capture_output=True,
        text=True,
    )
    print("\n".join(done.stderr.splitlines()[-5:]))
    assert done.returncode == 0, done.stderr[-4000:]
