"""Copies whose plants step together have the bytes of the Python, each for itself."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import seatrial_kits.native
from seatrial import Batch, Simulation
from seatrial.fmi.compiler import HERE, library_here
from seatrial_kits.batch import program

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

RIG = f"""
step = "10 ms"
[components]
wide  = {{ fmu = "{Path(__file__).with_name("operations.py")}:Wide" }}
drive = {{ fmu = "{Path(__file__).with_name("operations.py")}:Drive" }}
[connections]
"drive.push"  = "wide.push"
"wide.seen.a" = "drive.back"
"""
COPIES = 11
GAINS = np.linspace(0.4, 2.5, COPIES)


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("rig") / "wide.toml"
    path.write_text(RIG, "utf-8")
    return str(path)


@pytest.fixture(params=[frozenset({"avx512f"}), frozenset({"avx2"}), frozenset()])
def processor(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile for vectors of 8, of 4, and for none, as far as this processor can."""
    if not request.param <= program._processor():
        pytest.skip(f"this processor has no {', '.join(request.param)}")
    monkeypatch.setattr(program, "_processor", lambda: request.param)


def rows(rig: str, seed: int, given: dict[str, Any], names: list[str], count: int) -> Any:
    """Return the values of a run in Python after each step."""
    with Simulation(rig, engine="direct", seed=seed, set=given) as one:
        found = []
        for _ in range(count):
            one.step()
            found.append([float(one.get(name)) for name in names])
        return np.array(found)


@pytest.mark.usefixtures("processor")
def test_every_operation_has_the_bytes_of_the_python(rig: str) -> None:
    others = np.where(np.arange(COPIES) == 3, 2e-3, 1e-2)  # s: one takes sub-steps of its own
    with Batch(rig, COPIES, set={"wide.gain": GAINS, "wide.max_step": others}) as batch:
        names = list(batch.signals)
        found = batch.record(80, *names)
        assert batch.failures == {}
    for i in range(COPIES):
        given = {"wide.gain": float(GAINS[i]), "wide.max_step": float(others[i])}
        assert rows(rig, 1, given, names, 80).tobytes() == found[i].tobytes(), i


def test_a_copy_that_fails_leaves_the_others_in_step(rig: str) -> None:
    ends = np.where(np.arange(COPIES) == 5, 0.295, 1e9)
    with Batch(rig, COPIES, set={"wide.gain": GAINS}) as batch:
        expected = batch.record(60, "wide.x", "wide.seen.a")
        batch.reset(set={"drive.until": ends})
        found = batch.record(60, "wide.x", "wide.seen.a")
        assert batch.failures == {5: "drive: output push is inf at t = 0.3 s"}
        assert batch.time == pytest.approx(np.where(np.arange(COPIES) == 5, 0.3, 0.6))
    others = np.arange(COPIES) != 5
    assert found[others].tobytes() == expected[others].tobytes()
    assert np.isnan(found[5, 29:]).all()
    assert found[5, :29].tobytes() == expected[5, :29].tobytes()


def test_copies_outside_a_mask_stay_where_they_are(rig: str) -> None:
    mask = np.arange(COPIES) % 3 != 0
    with Batch(rig, COPIES, set={"wide.gain": GAINS}) as batch:
        batch.step(5)
        batch.step(7, mask)
        assert batch.time == pytest.approx(np.where(mask, 0.12, 0.05))
        batch.step(7, ~mask)
        found = batch.record(4, "wide.x", "wide.y", mask=mask)
        assert np.isnan(found[~mask]).all()
        batch.reset()
        batch.step(12)
        assert batch.record(4, "wide.x", "wide.y")[mask].tobytes() == found[mask].tobytes()


@pytest.mark.parametrize("name", ["hydrone-open-loop", "landing"])
def test_a_craft_among_others_has_the_bytes_of_the_python(name: str) -> None:
    with Batch(name, 5, seed=4) as batch:
        names = [n for n, signal in batch.signals.items() if signal.type is not str]
        found = batch.record(100, *names)
    assert rows(name, 6, {}, names, 100).tobytes() == found[2].tobytes()


CHECK = """
#include <math.h>
#include <stdint.h>
#include <string.h>
typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t Bits __attribute__((vector_size(8 * LANES)));
#define ALL(number) ((number) - (Lanes){0.0})
#define SIZE(v) ((Lanes)((Bits)(v) & INT64_MAX))
#include "sines.inc"

/* Return how many sines and cosines of `count` angles are not the bits of the library's. */
__attribute__((visibility("default"))) int differences(const double *angles, int count) {
    int found = 0;
    for (int k = 0; k < count; k += LANES) {
        Lanes x, s, c;
        memcpy(&x, angles + k, sizeof x);
        sines(x, &s, &c);
        for (int i = 0; i < LANES; i++) {
            const double sine = sin(x[i]), cosine = cos(x[i]), own[] = {s[i], c[i]};
            found += memcmp(own, &sine, 8) != 0;
            found += memcmp(own + 1, &cosine, 8) != 0;
        }
    }
    return found;
}
"""


@pytest.mark.usefixtures("processor")
def test_sines_have_the_bits_of_the_library(tmp_path: Path) -> None:
    options = program._options(program._processor())
    if not options:
        pytest.skip("no vectors")
    own = Path(seatrial_kits.native.__file__).with_name("sines.inc").read_bytes()
    library = tmp_path / "check.so"
    sources = {"check.c": CHECK.encode(), "sines.inc": own}
    library.write_bytes(library_here(sources, HERE, options=options))
    draw = np.random.default_rng(1)
    sizes = 10.0 ** draw.uniform(-9, 7, 800_000)
    near = np.arange(-4000, 4000) * (np.pi / 4) * (1.0 + draw.integers(-2, 3, 8000) * 2.0**-52)
    angles = [sizes * draw.choice([-1.0, 1.0], 800_000), near, draw.uniform(-4, 4, 800_000)]
    special = [0.0, -0.0, 5e-324, 1e-310, 1e22, 65536.0, -1e-8, 1.0]
    whole = np.concatenate([*angles, special])
    found = ctypes.CDLL(str(library)).differences(whole.ctypes.data_as(ctypes.c_void_p), len(whole))
    assert found == 0
