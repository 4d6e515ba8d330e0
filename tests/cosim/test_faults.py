"""Every fault of a signal against its definition, on the ramp x = t."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.stats

from seatrial.errors import InputError, SimulationError
from seatrial.model.faults.catalogue import SIGNALS
from seatrial.sim.faults import resolved
from seatrial.sim.master import Master
from seatrial.system.fault_entry import FaultEntry, read_fault

from .conftest import Bench, value

H, AT, LAST = 0.1, 0.3, 0.7
PARTS = 'ramp = { fmu = "users.py:Ramp" }\nadd = { fmu = "users.py:Add" }'
ALONG = '"ramp.y" = "add.u"'


def inject(master: Master, **written: Any) -> None:
    """Add a fault before or during a run."""
    entry = FaultEntry.model_validate(written)
    number = len(master.faults.faults)
    master.faults.add(resolved(master.system, entry, number, master.time_ns, f"faults.{number}"))


def series(bench: Bench, name: str, steps: int = 10, h: float = H, **written: Any) -> list[Any]:
    master = Master(bench.system(PARTS, ALONG, top=f'step = "{h} s"'))
    inject(master, **written)
    master.initialise()
    found = [value(master, name)]
    for _ in range(steps):
        master.step()
        found.append(value(master, name))
    return found


def share(t: float, over: float) -> float:
    return min(1.0, (t - AT) / over)


Q = math.exp(-H / 0.25)
KINDS = {
    "fixed": ({"value": 5.0}, lambda t: 5.0),
    "fixed, growing": (
        {"what": "fixed", "value": "50 dm", "grows_over": "0.2 s"},
        lambda t: t + share(t, 0.2) * (5.0 - t),
    ),
    "bias": ({"value": "-20 cm"}, lambda t: t - 0.2),
    "bias, growing": (
        {"what": "bias", "value": 2, "grows_over": "400 ms"},
        lambda t: t + 2.0 * share(t, 0.4),
    ),
    "bias, wrapped": (
        {"what": "bias", "value": 0.5, "wraps": [-1, 1]},
        lambda t: t + 0.5 if t + 0.5 < 0.999 else t - 1.5,
    ),
    "drift": ({"rate": "30 cm/s"}, lambda t: t + 0.3 * (t - AT)),
    "scale": ({"factor": 0.25}, lambda t: 0.25 * t),
    "scale, growing": (
        {"what": "scale", "factor": -1, "grows_over": "1 s"},
        lambda t: t * (1.0 - 2.0 * (t - AT)),
    ),
    "deviation": (
        {"coefficients": [0.1, 0.2, 0.3, 0.4, 0.5]},
        lambda t: t + 0.1 + 0.2 * math.sin(t) + 0.3 * math.cos(t) + 0.4 * math.sin(2 * t) + 0.5 * math.cos(2 * t),
    ),
    "stuck": ({}, lambda t: AT),
    "delay": ({"time": "0.2 s"}, lambda t: max(t - 0.2, AT)),
    "delay, growing": (
        {"what": "delay", "time": "0.2 s", "grows_over": "0.2 s"},
        lambda t: max(t - 0.2, AT),
    ),
    # e = x - y of a ramp that is held over each step: e' = h + q e.
    "lag": ({"time": "250 ms"}, lambda t: t - H * (1 - Q ** round((t - AT) / H)) / (1 - Q)),
    "rate-limit": ({"rate": "0.5 m/s"}, lambda t: AT + 0.05 * max(0, round((t - AT) / H) - 1)),
    "limit": ({"low": 0.35, "high": 0.5}, lambda t: min(max(t, 0.35), 0.5)),
    "runaway": ({"value": -1, "rate": "4 m/s"}, lambda t: max(AT - 4.0 * (t - AT), -1.0)),
    "nan": ({}, lambda t: math.nan),
}  # fmt: skip
RANDOM = {"noise", "garbage", "dropout"}


def test_every_fault_of_a_signal_is_tested() -> None:
    assert {name.partition(",")[0] for name in KINDS} | RANDOM == set(SIGNALS)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", KINDS)
def test_an_output_is_what_the_definition_says(bench: Bench, name: str) -> None:
    settings, expected = KINDS[name]
    where = {"what": name, **settings, "where": "ramp.y", "at": "0.3 s", "for": "0.4 s"}
    if name == "nan":
        with pytest.raises(SimulationError, match=r"add.*nan"):
            series(bench, "ramp.y", **where)
        return
    found = series(bench, "ramp.y", **where)
    times = [k * H for k in range(11)]
    acts = [AT - 1e-9 < t < LAST - 1e-9 for t in times]
    truth = [expected(t) if on else t for t, on in zip(times, acts, strict=True)]
    assert found == pytest.approx(truth, abs=1e-12)
    seen = series(bench, "add.y", **where)
    assert seen == pytest.approx([y + 1.0 for y in truth], abs=1e-12)


@pytest.mark.parametrize("name", [name for name in KINDS if name != "nan"])
def test_an_input_alone_is_what_the_definition_says(direct: Bench, name: str) -> None:
    settings, expected = KINDS[name]
    where = {"what": name, **settings, "where": "add.u", "at": "0.3 s", "for": "0.4 s"}
    assert series(direct, "ramp.y", **where) == pytest.approx([k * H for k in range(11)])
    found = series(direct, "add.y", **where)
    truth = [expected(k * H) if 3 <= k < 7 else k * H for k in range(11)]
    assert found == pytest.approx([y + 1.0 for y in truth], abs=1e-12)


@pytest.mark.parametrize("name", [n for n in KINDS if n not in ("lag", "rate-limit", "nan")])
def test_what_has_no_memory_is_the_same_with_every_step(direct: Bench, name: str) -> None:
    settings, _ = KINDS[name]
    where = {"what": name, **settings, "where": "ramp.y", "at": "0.3 s", "for": "0.4 s"}
    coarse = series(direct, "ramp.y", **where)
    fine = series(direct, "ramp.y", 50, 0.02, **where)
    assert fine[::5] == pytest.approx(coarse, abs=1e-12)


def test_noise_is_normal_new_in_each_interval_and_independent_of_the_step(direct: Bench) -> None:
    noise = {"what": "noise", "where": "ramp.y", "value": 2.0, "every": "0.1 s"}
    found = np.array(series(direct, "ramp.y", 3000, 0.1, **noise))
    drawn = (found - 0.1 * np.arange(3001)) / 2.0
    assert scipy.stats.kstest(drawn, "norm").pvalue > 1e-4
    assert abs(np.corrcoef(drawn[1:], drawn[:-1])[0, 1]) < 3.9 / math.sqrt(3000)
    fine = np.array(series(direct, "ramp.y", 500, 0.02, **noise))
    held = (fine - 0.02 * np.arange(501)) / 2.0
    assert held[:500] == pytest.approx(np.repeat(drawn[:100], 5), abs=1e-9)


def test_garbage_is_uniform_between_its_ends(direct: Bench) -> None:
    written = {"what": "garbage", "where": "ramp.y", "low": "-1 m", "high": "3 m"}
    found = series(direct, "ramp.y", 3000, **written)
    assert scipy.stats.kstest(found, "uniform", args=(-1.0, 4.0)).pvalue > 1e-4


def test_what_drops_out_is_the_value_before(direct: Bench) -> None:
    written = {"what": "dropout", "where": "ramp.y", "probability": 0.25}
    found = series(direct, "ramp.y", 3000, **written)
    held = 0
    for k in range(1, 3001):
        late = found[k] != pytest.approx(0.1 * k, abs=1e-9)
        assert not late or found[k] == found[k - 1]
        held += late
    assert abs(held - 750) < 3.9 * math.sqrt(3000 * 0.25 * 0.75)


def test_the_seed_and_the_place_in_the_list_decide_the_numbers(direct: Bench) -> None:
    noise = {"what": "noise", "where": "ramp.y", "value": 1.0}
    assert series(direct, "ramp.y", **noise) == series(direct, "ramp.y", **noise)
    master = direct.master(PARTS, ALONG)
    for _ in range(2):
        inject(master, **noise)
    master.faults.act(master)
    both, x = value(master, "ramp.y"), series(direct, "ramp.y", **noise)[0]
    assert both not in (2.0 * x, x)


def test_faults_of_one_signal_act_one_after_the_other(bench: Bench) -> None:
    master = bench.master(PARTS, ALONG)
    inject(master, what="bias", where="ramp.y", value=1.0)
    inject(master, what="scale", where="ramp.y", factor=2.0, at="0.1 s", **{"for": "0.1 s"})
    found = []
    for _ in range(3):
        master.step()
        found.append(value(master, "add.y"))
    assert found == pytest.approx([3.2, 2.2, 2.3], abs=1e-12)


def test_what_nothing_feeds_fails_too_and_may_be_set_meanwhile(bench: Bench) -> None:
    parts = 'sum = { fmu = "users.py:Sum", set = { u = 1.0 } }'
    master = Master(bench.system(parts))
    inject(master, what="bias", where="sum.u", value=2.0, at="0.2 s", **{"for": "0.2 s"})
    inject(master, what="scale", where="sum.rate", factor=10.0, at="0.6 s", **{"for": "0.1 s"})
    inject(master, what="fixed", where="sum.on", value=True, at="0.7 s")
    master.initialise()
    found = []
    for k in range(8):
        if k == 3:
            master.set("sum", ["u"], [2.0])
        master.step()
        found.append(value(master, "sum.x"))
    rates = [1.0, 1.0, 3.0, 4.0, 2.0, 2.0, 20.0, 2.0]
    assert found == pytest.approx(np.cumsum(rates) * 0.1, abs=1e-12)
    assert master.values("sum", ["u", "rate", "on"]) == [2.0, 1.0, True]


def test_integers_switches_and_texts_keep_their_types(bench: Bench) -> None:
    parts = 'turn = { fmu = "users.py:Turn" }'
    master = Master(bench.system(parts))
    inject(master, what="bias", where="turn.count", value=2.4)
    inject(master, what="fixed", where="turn.flag", value=True)
    inject(master, what="stuck", where="turn.text", at="0.1 s")
    inject(master, what="delay", where="turn.a", time="0.2 s")
    master.initialise()
    for _ in range(3):
        master.step()
    names = ("count", "flag", "text", "a")
    shown = [value(master, f"turn.{name}") for name in names]
    assert shown == [32, True, 'at "0.10", é', 91.0]


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel", "extrapolated", "iterated"])
def test_a_state_that_was_saved_comes_back_with_its_faults(bench: Bench, algorithm: str) -> None:
    top = f'step = "100 ms"\nalgorithm = "{algorithm}"'
    master = Master(bench.system(PARTS + '\nsum = { fmu = "users.py:Sum" }', '"ramp.y" = ["add.u", "sum.u"]', top=top))  # fmt: skip
    inject(master, what="lag", where="ramp.y", time="0.3 s", at="0.1 s", **{"for": "0.8 s"})
    inject(master, what="delay", where="add.u", time="0.2 s", at="0.2 s")
    inject(master, what="dropout", where="sum.u", probability=0.5)
    inject(master, what="drift", where="sum.rate", rate=0.1, at="0.3 s", **{"for": "0.5 s"})
    master.initialise()
    for _ in range(5):
        master.step()
    state = master.save()
    runs = []
    for _ in range(2):
        rows = []
        for _ in range(8):
            master.step()
            rows.append(list(master.signals))
        runs.append(rows)
        master.restore(state)
    assert runs[0] == runs[1]


def test_a_discarded_step_is_repeated_with_its_faults(bench: Bench) -> None:
    """What a fault remembers follows the steps that are run again."""
    late = {"what": "delay", "where": "ramp.y", "time": "1 s"}
    found = []
    for after in ("5.95 s", "1000 s"):
        parts = (
            PARTS
            + f'\ncoarse = {{ fmu = "bodies.py:Coarse", set = {{ after = "{after}", limit = "60 ms" }} }}'
        )
        master = Master(bench.system(parts, ALONG))
        inject(master, **late)
        master.initialise()
        for _ in range(61):
            master.step()
        found.append(value(master, "add.y"))
        assert ("discarded" in "".join(master.notes())) == (after == "5.95 s")
    assert found[0] == found[1]


# ---------------------------------------------------------------------- whole components


def test_a_component_that_hangs_shows_what_it_showed_and_goes_on(bench: Bench) -> None:
    parts = PARTS + '\nsum = { fmu = "users.py:Sum" }'
    master = Master(bench.system(parts, '"add.y" = "sum.u"\n"ramp.y" = "add.u"'))
    inject(master, what="hang", where=["add", "sum"], at="0.2 s", **{"for": "0.3 s"})
    master.initialise()
    found = []
    for _ in range(6):
        master.step()
        found.append((value(master, "add.y"), value(master, "sum.x")))
    assert [y for y, _ in found] == pytest.approx([1.1, 1.2, 1.2, 1.2, 1.5, 1.6])
    # It has summed what it saw as it stopped, and shows that when it goes on.
    assert [x for _, x in found[:4]] == pytest.approx([0.1, 0.21, 0.21, 0.21])
    assert found[4][1] == pytest.approx(0.21 + 3 * 0.12)


@pytest.mark.parametrize(("what", "meanwhile"), [("crash", 0.03), ("power-loss", 0.0)])
def test_a_component_that_crashed_starts_anew(bench: Bench, what: str, meanwhile: float) -> None:
    parts = 'ramp = { fmu = "users.py:Ramp" }\nsum = { fmu = "users.py:Sum", set = { rate = 1 } }'
    master = Master(bench.system(parts, '"ramp.y" = "sum.u"'))
    inject(master, what=what, where="sum", at="0.3 s", **{"for": "0.2 s"})
    master.initialise()
    found = []
    for _ in range(7):
        master.step()
        found.append(value(master, "sum.x"))
    assert found == pytest.approx([0.0, 0.01, meanwhile, meanwhile, 0.0, 0.05, 0.11], abs=1e-12)


def test_a_whole_component_that_is_not_a_number_ends_what_reads_it(direct: Bench) -> None:
    master = Master(direct.system(PARTS, ALONG))
    inject(master, what="nan", where="ramp", at="0.2 s")
    master.initialise()
    master.step()
    with pytest.raises(SimulationError, match=r"add.u: nan is not a finite number"):
        master.step()


# ---------------------------------------------------------------------- as text


def test_a_fault_on_the_command_line_is_that_of_a_file() -> None:
    assert read_fault("gnss=off", "--fault") == {"where": "gnss", "what": "off"}
    text = 'a.b + c.d = bias, value=["5 m", 0, 1.5], at=2 s, for = 500 ms'
    assert read_fault(text, "--fault") == {
        "where": ["a.b", "c.d"],
        "what": "bias",
        "value": ["5 m", 0, 1.5],
        "at": "2 s",
        "for": "500 ms",
    }
    for wrong in ("gnss", "=off", "gnss=off, for", "gnss=", ""):
        with pytest.raises(InputError, match="--fault: "):
            read_fault(wrong, "--fault")
