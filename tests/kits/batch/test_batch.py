"""Copies in compiled code: the bytes of single runs, closed forms, and clear mistakes."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from seatrial import Batch, InputError, Simulation, run_trial

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

PARTS = Path(__file__).with_name("parts.py")
RIG = f"""
step = "10 ms"
[components]
cork  = {{ fmu = "{PARTS}:Cork" }}
log   = {{ fmu = "speed-log", set = {{ period = "50 ms" }} }}
pilot = {{ fmu = "{PARTS}:Pilot" }}
[connections]
"cork.nu_r"            = "log.nu_r"
"cork.x"               = "pilot.place"
"log.water_velocity.u" = "pilot.speed"
"pilot.force"          = "cork.push"
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("rig") / "cork.toml"
    path.write_text(RIG, "utf-8")
    return path


def everything(one: Simulation) -> list[float]:
    return [float(one.get(name)) for name in one.signals]


def single(rig: Path, seed: int, given: dict[str, float], act: Callable[[Simulation], None]):
    with Simulation(rig, engine="native", seed=seed, set=given) as one:
        act(one)
        return everything(one)


@settings(max_examples=8)
@given(
    seeds=st.lists(st.integers(0, 2**31), min_size=5, max_size=5),
    masses=st.lists(st.floats(0.5, 5.0), min_size=5, max_size=5),
    streams=st.lists(st.sampled_from([0.0, 0.2, -0.7]), min_size=5, max_size=5),
    wanted=st.lists(st.floats(-2.0, 2.0), min_size=5, max_size=5),
    threads=st.integers(1, 4),
    again=st.lists(st.booleans(), min_size=5, max_size=5),
)
def test_a_copy_has_the_bytes_of_a_single_run(
    seeds, masses, streams, wanted, threads, again, rig: Path
) -> None:
    given = {"cork.mass": np.array(masses), "cork.current_speed": np.array(streams)}
    with Batch(rig, 5, set=given, seed=seeds, threads=threads) as batch:
        names = list(batch.signals)
        batch.step(7)
        batch.set("pilot.wanted", np.array(wanted))
        batch.step(20)
        # Some start anew, as the others go on.
        batch.reset(np.array(again), set={"cork.mass": 1.25, "pilot.gain": 3.0})
        batch.step()
        batch.step(12)
        found = batch.get(*names)
    for i in range(5):

        def act(one: Simulation, wanted: float = wanted[i]) -> None:
            one.step(7)
            one.set("pilot.wanted", wanted)
            one.step(33)

        own = {"cork.mass": masses[i], "cork.current_speed": streams[i]}
        if again[i]:
            own |= {"cork.mass": 1.25, "pilot.gain": 3.0}
            expected = single(rig, seeds[i], own, lambda one: one.step(13))
        else:
            expected = single(rig, seeds[i], own, act)
        assert [v.hex() for v in found[i].tolist()] == [v.hex() for v in expected]


def test_threads_of_which_one_steps_copies_together_leave_each_other_alone(rig: Path) -> None:
    """Of five copies one thread has two, one by one, the other three, which can step in lanes."""
    found = []
    for threads in (1, 2):
        with Batch(rig, 5, seed=1, threads=threads) as batch:
            for k in range(1000):
                batch.set("pilot.wanted", np.arange(5.0) + k % 2)  # read as the step begins
                batch.step(50)
            found.append((batch.failures, batch.get(*batch.signals).tobytes()))
    assert found[0] == found[1]


def test_a_single_simulation_starts_anew_in_other_water(rig: Path) -> None:
    given = {"cork.current_speed": 0.4, "cork.mass": 3.0}
    expected = single(rig, 8, given, lambda one: one.step(25))
    with Simulation(rig, engine="native") as one:
        one.step(5)
        one.reset(set=given, seed=8)
        one.step(25)
        assert everything(one) == expected
        with pytest.raises(InputError, match="'linear', built into this FMU"):
            one.reset(set={"cork.form": "square"})
        one.reset()
        one.step(25)
        assert everything(one) == expected


def test_each_copy_follows_its_closed_form(rig: Path) -> None:
    """Without a pilot, v = stream (1 - exp(-drag t / mass))."""
    streams, masses = np.array([0.0, 0.3, 1.0]), np.array([1.0, 2.0, 4.0])
    with Batch(
        rig, 3, set={"cork.current_speed": streams, "cork.mass": masses, "pilot.gain": 0.0}
    ) as batch:
        batch.step(100)
        # The pilot's damping by the log, 2 (v - stream), adds to the drag.
        rate = 3.0 / masses
        assert batch.get("cork.v") == pytest.approx(streams * (1.0 - np.exp(-rate)), abs=0.03)
        assert batch.time.tolist() == [1.0, 1.0, 1.0]


def test_an_override_acts_as_that_of_a_single_run(rig: Path) -> None:
    with Batch(rig, 3, seed=5) as batch:
        names = list(batch.signals)
        batch.set("pilot.wanted", 1.0)
        batch.step(10)
        batch.override("pilot.force", np.array([0.5, 0.0, -2.0]), np.array([True, False, True]))
        batch.override("cork.x", 3.0, np.array([False, False, True]))
        during = [batch.get(*names)]
        batch.step(10)
        during.append(batch.get(*names))
        saved = batch.save()
        batch.release("pilot.force")
        batch.release("cork.x")
        during.append(batch.get(*names))
        batch.step(10)
        during.append(batch.get(*names))
        batch.restore(saved)
        batch.step()
        assert batch.get("pilot.force")[[0, 2]].tolist() == [0.5, -2.0]
        batch.reset()
        assert batch.get("cork.x").tolist() == [0.0, 0.0, 0.0]
    for i, force in enumerate((0.5, None, -2.0)):
        with Simulation(rig, engine="native", seed=5 + i) as one:
            one.set("pilot.wanted", 1.0)
            one.step(10)
            if force is not None:
                one.override("pilot.force", force)
            if i == 2:
                one.override("cork.x", 3.0)
            assert everything(one) == during[0][i].tolist()
            one.step(10)
            assert everything(one) == during[1][i].tolist()
            if force is not None:
                one.release("pilot.force")
            if i == 2:
                one.release("cork.x")
            assert everything(one) == during[2][i].tolist()
            one.step(10)
            assert everything(one) == during[3][i].tolist()


def test_copies_go_on_from_the_states_of_others(rig: Path) -> None:
    with Batch(rig, 4, seed=9) as batch:
        batch.set("pilot.wanted", np.arange(4.0))
        batch.step(30)
        saved = batch.save()
        batch.step(10)
        later = batch.get(*batch.signals)
        batch.restore(saved)
        batch.step(10)
        assert (batch.get(*batch.signals) == later).all()
        batch.restore(saved, np.array([True, True, False, True]), source=np.array([3, 3, 0, 0]))
        assert batch.time == pytest.approx([0.3, 0.3, 0.4, 0.3])
        batch.step(10)
        found = batch.get(*batch.signals)
        assert (found[:2] == later[3]).all()
        assert (found[3] == later[0]).all()
        with Batch(rig, 4) as other, pytest.raises(InputError, match="another batch"):
            other.restore(saved)
        with pytest.raises(InputError, match="0 to 3, are needed"):
            batch.restore(saved, source=np.array([0, 1, 2, 4]))


def test_a_state_brings_the_stream_that_it_was_in(rig: Path) -> None:
    """Of another copy, and of before a start in other water; of a single simulation, too."""
    streams = np.array([0.0, 0.4, -0.6])
    with Batch(rig, 3, set={"cork.current_speed": streams}, seed=[7, 7, 7]) as batch:
        batch.step(20)
        saved = batch.save()
        batch.step(20)
        wanted = batch.get(*batch.signals)
        batch.reset(set={"cork.current_speed": np.array([0.9, 0.0, 0.9])})
        batch.step(5)
        batch.restore(saved, source=np.array([2, 0, 1]))
        batch.step(20)
        assert (batch.get(*batch.signals) == wanted[[2, 0, 1]]).all()
    with Simulation(rig, engine="native", seed=7, set={"cork.current_speed": 0.4}) as one:
        one.step(20)
        state = one.save()
        one.reset(set={"cork.current_speed": 0.0})
        one.step(5)
        one.restore(state)
        one.step(20)
        assert everything(one) == wanted[1].tolist()


def test_a_copy_that_fails_ends_alone_with_its_message(rig: Path) -> None:
    reach = np.array([1e9, 0.5, 1e9])
    with Batch(rig, 3, set={"pilot.reach": reach}, threads=2) as batch:
        batch.step(5)
        batch.set("pilot.wanted", 1.0, np.array([True, False, True]))
        batch.set("pilot.wanted", np.array([0.0, 0.4, 0.0]), np.array([False, True, False]))
        assert batch.failures == {}
        batch.set("pilot.wanted", 1.0)
        batch.step(5)
        [(number, why)] = batch.failures.items()
        assert number == 1
        assert "pilot: output force is inf" in why
        assert batch.time.tolist() == pytest.approx([0.1, batch.time[1], 0.1])
        batch.step(5)
        assert batch.time[[0, 2]] == pytest.approx([0.15, 0.15])
        batch.reset(np.array([False, True, False]), set={"pilot.reach": 10.0})
        batch.step(5)
        assert batch.failures == {}
        assert batch.time == pytest.approx([0.2, 0.05, 0.2])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda b: b.set("pilot.place", 1.0), "pilot.place is fed by cork.x"),
        (lambda b: b.set("pilot.force", 1.0), "pilot.force is an output; it can be over"),
        (lambda b: b.override("pilot.wanted", 1.0), "pilot.wanted is no output; set it"),
        (lambda b: b.override("pilot.force", [1.0, 2.0]), r"has shape \(2,\)"),
        (lambda b: b.set("cork.mass", 1.0), "cork.mass is fixed once a copy has started; reset"),
        (lambda b: b.set("pilot.wnted", 1.0), "wanted"),
        (lambda b: b.set("plot.wanted", 1.0), "pilot"),
        (lambda b: b.set("pilot.wanted", [1.0, 2.0]), r"has shape \(2,\)"),
        (lambda b: b.set("pilot.wanted", np.ones((3, 2))), r"has shape \(3, 2\)"),
        (lambda b: b.set("pilot.wanted", [1.0, math.nan, 0.0]), "copy 1 gets nan"),
        (lambda b: b.set("pilot.wanted", "2 kg"), "kg"),
        (lambda b: b.set("pilot.idle", [0.0, 0.5, 1.0]), "copy 1 gets 0.5 for idle, 0 or 1 is"),
        (lambda b: b.set("pilot.wanted", 1.0, [True, False]), r"3 truths are needed"),
        (lambda b: b.set("pilot.wanted", 1.0, np.ones(3)), r"float64; 3 truths"),
        (
            lambda b: b.reset(set={"cork.mass": [1.0, 0.01, 1.0]}),
            r"copy 1: mass = 0.01 kg is not in its range 0.1 <= mass",
        ),
        (lambda b: b.reset(set={"cork.mass": 0.0}), r"mass = 0.0 kg is not in its range"),
        (lambda b: b.reset(set={"cork.form": "square"}), "is a text"),
        (lambda b: b.reset(seed=1.5), "one whole number, or 3"),
        (lambda b: b.reset(seed=[1, 2]), "one whole number, or 3"),
        (lambda b: b.get("cork.form"), "cork.form is a text"),
        (lambda b: b.get("cork.y"), "cork"),
        (lambda b: b.step(-1), "cannot be negative"),
    ],
)
def test_a_mistake_is_named_and_changes_nothing(call, message: str, rig: Path) -> None:
    with Batch(rig, 3) as batch:
        batch.step(3)
        before = batch.get(*batch.signals)
        with pytest.raises(InputError, match=message):
            call(batch)
        assert (batch.get(*batch.signals) == before).all()
        batch.reset()
        batch.step(3)
        assert (batch.get(*batch.signals) == before).all()


def test_text_is_built_in(rig: Path) -> None:
    with Batch(rig, 2, set={"cork.form": "square", "cork.v_start": "1 m/s"}) as batch:
        assert batch.get("cork.v").tolist() == [1.0, 1.0]
        batch.set("pilot.gain", 0.0)
        batch.step(10)
    expected = single(
        rig,
        1,
        {"cork.form": "square", "cork.v_start": 1.0, "pilot.gain": 0.0},
        lambda o: o.step(10),
    )
    assert batch.count == 2
    assert len(expected) > 3


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"count": 0}, "at least 1"),
        ({"count": 2, "threads": 0}, "allowed 1 to 64"),
        ({"count": 2, "seed": [1, 2, 3]}, "one whole number, or 2"),
        ({"count": 2, "set": {"cork.mass": -1.0}}, "cork.mass"),
        ({"count": 2, "set": {"cork.form": "cubic"}}, "cubic"),
    ],
)
def test_what_cannot_begin_is_refused(given, message: str, rig: Path) -> None:
    with pytest.raises(InputError, match=message):
        Batch(rig, **given)


def test_each_copy_of_a_shipped_rig_has_a_sea_of_its_own() -> None:
    sea = {"hull.sea_height": np.array([0.1, 0.3]), "hull.sea_period": np.array([3.0, 2.0])}
    common = {"hull.sea_spectrum": "jonswap", "hull.wind_speed": 3.0}
    with Batch("hydrone-open-loop", 2, set={**sea, **common}) as batch:
        batch.step(100)
        names = [n for n, signal in batch.signals.items() if signal.type is not str]
        found = batch.get(*names)
        with pytest.raises(InputError, match=r"height is 0.0 m, more than 0 is needed"):
            batch.reset(set={"hull.sea_height": np.array([0.1, 0.0])})
        assert (batch.get(*names) == found).all()
        batch.reset()
        batch.step(100)
        assert (batch.get(*names) == found).all()
    for i in range(2):
        own = {name: float(values[i]) for name, values in sea.items()}
        with Simulation("hydrone-open-loop", engine="native", seed=1 + i, set=common | own) as one:
            one.step(100)
            assert [float(one.get(n)) for n in names] == found[i].tolist()


def test_a_rig_with_python_in_it_is_refused_by_the_component(tmp_path: Path) -> None:
    path = tmp_path / "bus.toml"
    path.write_text('step = "10 ms"\n[components]\nbus = { fmu = "canbus" }\n', "utf-8")
    with pytest.raises(
        InputError, match=r"bus.toml: copies of it cannot be compiled; bus: canbus cannot be native"
    ):
        Batch(path, 2)


def test_a_closed_batch_says_so(rig: Path) -> None:
    batch = Batch(rig, 2)
    saved = batch.save()
    batch.close()
    batch.close()
    del saved
    with pytest.raises(InputError, match="closed"):
        batch.step()
    assert "closed" in repr(batch)


@pytest.mark.parametrize("name", ["hydrone-open-loop", "landing"])
def test_shipped_rigs_have_the_bytes_of_single_runs(name: str) -> None:
    with Batch(name, 3, seed=4, threads=2) as batch:
        batch.step(150)
        names = [n for n, signal in batch.signals.items() if signal.type is not str]
        found = batch.get(*names)
    for i in (0, 2):
        with Simulation(name, engine="native", seed=4 + i) as one:
            one.step(150)
            assert [float(one.get(n)) for n in names] == found[i].tolist()


TRIAL = """
rig = "cork.toml"
stop = "1 s"
seed = 4
[set]
"cork.mass" = "3 kg"
[[events]]
at = "0 s"
set = { "pilot.wanted" = "50 cm" }
[[events]]
at = "100 ms"
set = { "pilot.wanted" = 1.0, "pilot.gain" = "2 N/m" }
[[faults]]
what = "fixed"
where = "pilot.force"
value = "0.5 N"
at = "150 ms"
for = "70 ms"
"""


def test_copies_of_a_trial_have_its_events_and_faults(rig: Path) -> None:
    path = rig.with_name("trial.toml")
    path.write_text(TRIAL, "utf-8")
    with Batch(path, 3, seed=[4, 4, 9]) as batch:
        names = list(batch.signals)
        batch.step(12)
        batch.reset(np.array([False, True, False]))
        batch.step(28)
        found = batch.get(*names)
    for i, (seed, steps) in enumerate([(None, 40), (4, 28), (9, 40)]):
        with Simulation(path, engine="native", seed=seed) as one:
            one.step(steps)
            assert everything(one) == found[i].tolist()
    trial = run_trial(path, out=rig.parent / "run", set={"stop": "0.4 s"})
    last = [float(trial.signals[name][-1]) for name in names]
    assert last == found[0].tolist()


def test_a_copy_runs_alone_into_a_folder(rig: Path) -> None:
    path = rig.with_name("trial.toml")
    path.write_text(TRIAL, "utf-8")
    with Batch(path, 3, seed=6, set={"cork.mass": np.array([1.0, 2.0, 4.0])}) as batch:
        names = list(batch.signals)
        rows = batch.record(40, *names)
        assert rows.shape == (3, 40, len(names))
        assert batch.settings(1) == {"seed": 7, "cork.mass": 2.0}
        trial = run_trial(
            path, out=rig.parent / "alone", set={**batch.settings(2), "stop": "0.4 s"}
        )
        with pytest.raises(InputError, match="copy is 3, allowed 0 to 2"):
            batch.settings(3)
    for name, column in zip(names, rows[2].T, strict=True):
        assert [float(v) for v in trial.signals[name][1:]] == column.tolist()


def test_a_simulation_of_a_trial_starts_anew_with_its_events(rig: Path) -> None:
    path = rig.with_name("trial.toml")
    path.write_text(TRIAL, "utf-8")
    with Simulation(path) as one:
        assert one.get("pilot.wanted") == 0.5
        one.step(9)
        assert one.get("pilot.wanted") == 0.5
        one.step(6)
        assert one.get("pilot.wanted") == 1.0
        assert one.get("pilot.force") == 0.5
        early = one.save()
        one.step(10)
        late = everything(one)
        one.restore(early)
        one.step(10)
        assert everything(one) == late
        one.reset()
        one.step(25)
        assert everything(one) == late


LOG = 'where = "log", at = "{at} ms", for = "{lasts} ms"'
FAULTS = [
    f'{{{{ what = "off", {LOG} }}}}',
    f'{{{{ what = "stuck", {LOG} }}}}',
    f'{{{{ what = "intermittent", {LOG} }}}}',
    f'{{{{ what = "bias", of = "water_velocity", value = "0.3 m/s", grows_over = "80 ms", {LOG} }}}}',
    f'{{{{ what = "noise", of = "water_velocity", value = "0.3 m/s", {LOG} }}}}',
    '{{ what = "stuck", where = "pilot.force", at = "{at} ms", for = "{lasts} ms" }}',
    '{{ what = "fixed", where = "log.water_velocity.u", value = "1 m/s", at = "{at} ms" }}',
]


@settings(max_examples=12)
@example(fault=FAULTS[5], at=0, lasts=1, seed=1)  # with the events of the trial
@example(fault=FAULTS[5], at=10, lasts=9, seed=1)
@given(
    fault=st.sampled_from(FAULTS),
    at=st.integers(0, 30),
    lasts=st.integers(1, 20),
    seed=st.integers(1, 2**31),
)
def test_a_fault_of_a_trial_acts_as_in_a_single_run(
    fault: str, at: int, lasts: int, seed: int, rig: Path
) -> None:
    path = rig.with_name("faulty.toml")
    whole = TRIAL[: TRIAL.index("[[faults]]")].replace("[set]", "faults = [FAULT]\n[set]")
    path.write_text(whole.replace("FAULT", fault.format(at=10 * at, lasts=10 * lasts)), "utf-8")
    with Batch(path, 2, seed=seed) as batch:
        names = list(batch.signals)
        batch.step(17)
        batch.reset(np.array([False, True]))
        batch.step(21)
        found = batch.get(*names)
    for i, steps in enumerate([38, 21]):
        with Simulation(path, engine="native", seed=seed + i) as one:
            one.step(steps)
            assert everything(one) == found[i].tolist()


def test_a_fault_that_copies_have_not_is_named(rig: Path) -> None:
    path = rig.with_name("biased.toml")
    path.write_text(TRIAL.replace('"fixed"', '"bias"'), "utf-8")
    with pytest.raises(InputError, match=r"biased.toml: faults.0: .* have faults of devices, and"):
        Batch(path, 2)
    path.write_text(TRIAL + TRIAL[TRIAL.index("[[faults]]") :], "utf-8")
    with pytest.raises(InputError, match=r"faults.1: pilot.force has another fault or an event"):
        Batch(path, 2)


def test_the_fault_of_a_device_is_a_text(rig: Path) -> None:
    with Batch(rig, 2, set={"cork.current_speed": 0.5}) as batch:
        batch.set("log.fault", "off", np.array([True, False]))
        batch.step(20)
        assert (batch.get("log.water_velocity.u") != 0.0).tolist() == [False, True]
        with pytest.raises(InputError, match=r"set: log\.fault is a text, found 1\.0"):
            batch.set("log.fault", 1.0)


def test_each_copy_of_a_trial_in_waves_has_its_own_height_and_seed() -> None:
    heights = np.array([0.1, 0.2, 0.1])
    with Batch("hydrone-landing-waves", 3, seed=5, set={"sea.height": heights}) as batch:
        names = [n for n, signal in batch.signals.items() if signal.type is not str]
        batch.step(20)
        batch.reset(set={"sea.height": heights[::-1]}, seed=8)
        batch.step(60)
        found = batch.get(*names)
        assert len({tuple(row) for row in found.tolist()}) == 3
    for i in range(3):
        with Simulation("hydrone-landing-waves", engine="native", seed=1) as one:
            one.step(2)
            one.reset(set={"sea.height": heights[2 - i]}, seed=8 + i)
            one.step(60)
            assert [float(one.get(n)) for n in names] == found[i].tolist()
        settings = {"sea.height": float(heights[2 - i])}
        with Simulation("hydrone-landing-waves", seed=8 + i, set=settings) as one:
            one.step(60)
            assert [float(one.get(n)) for n in names] == found[i].tolist()
