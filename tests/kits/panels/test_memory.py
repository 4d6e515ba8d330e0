"""Memory of radiated waves against the tables that it is fitted to, and its energy."""

from functools import cache

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.panels.memory import GROUPS, memories
from tests.sea.references import table


def panels(body):
    """Return frequencies, A, B (w, 6, 6) and A at infinite frequency of a reference body."""
    rows = table(f"coef_{body}")
    matrices = {"A": np.zeros((len(rows), 6, 6)), "B": np.zeros((len(rows), 6, 6))}
    for name in rows.dtype.names[1:]:
        i, j = int(name[1]) - 1, int(name[2]) - 1
        matrices[name[0]][:, i, j] = matrices[name[0]][:, j, i] = rows[name]
    assert np.isinf(rows["omega"][-1])
    return rows["omega"][:-1], matrices["A"][:-1], matrices["B"][:-1], matrices["A"][-1]


@cache
def fitted(body):
    """Return the memories of a reference body: seconds to fit."""
    return memories(*panels(body))


# A wave trapped between its two hulls makes sharp peaks of the catamaran's radiation. The least
# squares stop before they rest, elsewhere with another MINPACK: 0.054 with SciPy 1.17, 0.059 with 1.18.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "error"), [("barge_T020", 0.06), ("wigley_160", 0.025), ("cat_13", 0.1)]
)
def test_it_is_near_the_panels(body, error):
    w, added, damping, infinite = panels(body)
    wanted = damping + 1j * w[:, None, None] * (added - infinite)
    for memory, group in zip(fitted(body), GROUPS, strict=True):
        found = memory.response(w)
        for n, motion in enumerate(group):
            largest = np.abs(wanted[:, motion, motion]).max()
            assert np.abs(found[:, n, n] - wanted[:, motion, motion]).max() < error * largest


@pytest.mark.slow
def test_it_says_what_it_misses_of_each_motion():
    w, added, damping, infinite = panels("barge_T020")
    for memory, group in zip(fitted("barge_T020"), GROUPS, strict=True):
        for n, motion in enumerate(group):
            own = damping + 1j * w[:, None, None] * (added - infinite)
            own = own[:, motion, motion]
            off = memory.response(w)[:, n, n] - own
            assert memory.missed[n] == pytest.approx(
                np.sqrt((np.abs(off) ** 2).sum() / (np.abs(own) ** 2).sum()), rel=1e-9
            )
            assert memory.missed[n] < 0.02


@pytest.mark.slow
def test_one_motion_that_no_memory_gives_is_enough_to_refuse_and_is_named():
    # Its damping alternates from frequency to frequency; its group has an error of 17 %.
    w, added, damping, infinite = panels("barge_T020")
    damping = damping.copy()
    damping[::2, 5, 5] *= 1.6
    damping[1::2, 5, 5] *= 0.4
    with pytest.raises(InputError, match=r"yaw [2-9]\d%") as refused:
        memories(w, added, damping, infinite)
    assert "surge 0%" in str(refused.value)


@pytest.mark.slow
@pytest.mark.parametrize("body", ["barge_T020", "cat_13"])
def test_it_takes_energy_at_every_frequency_and_from_every_motion(body):
    for memory in fitted(body):
        taken = memory.response(np.geomspace(1e-3, 1e3, 300))
        size = np.abs(taken).max()
        assert np.linalg.eigvalsh(taken.real).min() > -1e-12 * size
        # Nothing holds back what moves steadily.
        assert np.abs(memory.response(np.array([1e-6]))).max() < 1e-5 * size


@pytest.mark.slow
def test_its_states_are_its_response():
    memory = fitted("barge_T020")[0]
    n = len(memory.omega)
    w = np.diag(memory.omega)
    a = np.block([[-memory.damping, -w], [w, np.zeros((n, n))]])
    b = np.vstack([memory.coupling, np.zeros_like(memory.coupling)])
    for at in (0.5, 4.0, 12.0):
        force = b.T @ np.linalg.solve(1j * at * np.eye(2 * n) - a, b)
        np.testing.assert_allclose(force, memory.response(np.array([at]))[0], rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_tables_that_no_memory_gives_are_refused():
    w, added, damping, infinite = panels("barge_T020")
    with pytest.raises(InputError, match="do not belong together"):
        memories(w, added, damping, 1.3 * infinite)
    aside = damping.copy()
    aside[:, 1, 2] = aside[:, 2, 1] = damping[:, 2, 2]
    with pytest.raises(InputError, match="alike on both sides"):
        memories(w, added, aside, infinite)
