"""States of simulations: saved, restored as often as needed, released."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from seatrial import InputError, Simulation, SimulationError
from seatrial.sim.master import Master

Rig = Callable[..., str]


@pytest.mark.parametrize(
    ("algorithm", "slow", "engine"),
    [
        ("jacobi", "", "direct"),
        ("jacobi", "", "fmu"),
        ("jacobi", ', step = "300 ms"', "direct"),
        ("plain-jacobi", "", "direct"),
        ("gauss-seidel", ', step = "300 ms"', "direct"),
        ("extrapolated", "", "direct"),
        ("iterated", "", "direct"),
    ],
)
def test_a_restored_simulation_takes_the_same_course(
    algorithm: str, slow: str, engine: str, rig: Rig
) -> None:
    """Whatever was set, overridden and released in between."""
    with Simulation(rig(algorithm, slow), engine=engine) as sim:
        sim.set("source.level", 3.0)
        sim.override("spring.x", 0.7)
        sim.override("source.y", 4.0)
        sim.step(4)
        state = sim.save()
        assert state.time == 0.4

        def course() -> list[list[Any]]:
            rows = []
            for step in range(40):
                if step == 10:
                    sim.release("spring.x")
                if step == 20:
                    sim.release("source.y")
                sim.step()
                rows.append([sim.time, *(sim.get(name) for name in [*sim.signals, "spring.x"])])
            return rows

        first = course()
        sim.set("source.level", 9.0)
        sim.override("lag.u", -1.0)
        sim.override("body.x", 0.1)
        sim.step(3)
        for _ in range(2):
            sim.restore(state)
            assert (sim.time, sim.get("source.level"), sim.get("source.y")) == (0.4, 3.0, 4.0)
            assert course() == first


def test_noise_and_overrides_of_a_shipped_rig_are_restored() -> None:
    with Simulation("landing", seed=5) as sim:
        sim.override("autopilot.keeper.pulse_port", "1.6 ms")
        sim.run(1)
        recorded = "vehicle.gnss.*", "vehicle.compass.*", "vehicle.hull.position"
        state, recording = sim.save(), sim.record(*recorded)
        sim.run(2)
        sim.release("autopilot.keeper.pulse_port")
        sim.run("2.5 s")
        sim.restore(state)
        sim.run(2)
        signals = recording.signals
    again = signals.t.tolist().index(1.01, 2)
    fixes = signals["vehicle.gnss.position_n"][:100, 0].tolist()
    assert len(set(fixes)) > 3  # it does come with noise
    for name in signals:
        assert signals[name][1:101].tolist() == signals[name][again : again + 100].tolist(), name


def test_an_override_that_was_restored_ends_with_the_outputs_own_value(rig: Rig) -> None:
    with Simulation(rig()) as sim:
        sim.override("body.x", 0.25)
        sim.step(3)
        state = sim.save()
        sim.release("body.x")
        own = sim.get("body.x")
        sim.step()
        sim.restore(state)
        assert sim.get("body.x") == 0.25
        sim.release("body.x")
        assert sim.get("body.x") == own != 0.25


def test_divergence_is_watched_after_a_restore_as_without(rig: Rig) -> None:
    """The watch counts blocks of steps: it would forget, or count those of another course."""
    path = rig(more='over = { fmu = "parts.py:Overshoot" }', connection='"over.y" = "over.u"\n')

    def ends(simulation: Simulation) -> str:
        with pytest.raises(SimulationError, match="swings from step to step") as caught:
            simulation.step(200)
        return str(caught.value)

    with Simulation(path) as sim:
        sim.step(30)
        state = sim.save()
        first = ends(sim)
        with pytest.raises(SimulationError, match=r"ended at t = .*diverges"):
            sim.step()
        sim.restore(state)
        assert ends(sim) == first


def test_steps_that_are_refused_are_split_after_a_restore_too(rig: Rig) -> None:
    """They are repeated from states that the master saved, which must be of the same course."""
    with Simulation(rig(more='careful = { fmu = "parts.py:Careful" }')) as sim:
        sim.step(5)
        early = sim.save()
        sim.step(2)
        sim.set("source.level", 5.0)  # the master saves its states after this
        sim.step(3)
        assert sim.get("careful.halves") == 0
        sim.restore(early)
        sim.run("1.3 s")
        assert sim.get("careful.halves") == 6
        assert sim.get("careful.y") == pytest.approx(1.3, rel=1e-12)
        assert sim.get("lag.y") == pytest.approx(1.0 - math.exp(-2.6), rel=1e-12)


def test_a_simulation_goes_on_from_a_restored_state_after_a_failure(rig: Rig) -> None:
    with Simulation(rig(), set={"types.fails": 0.5}) as sim:
        state = sim.save()
        with pytest.raises(SimulationError, match="the boat has sunk"):
            sim.run(1)
        with pytest.raises(SimulationError, match=r"this simulation ended at t = 0\.5 s"):
            sim.set("source.level", 2.0)
        assert sim.get("types.turn") == 0.5  # what it was can still be seen
        sim.restore(state)
        sim.run(0.5)
        assert sim.time == 0.5


def test_states_are_released_when_nothing_refers_to_them(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of FMUs are memory outside Python."""
    released: list[float] = []
    free = Master.free
    monkeypatch.setattr(
        Master,
        "free",
        lambda self, snapshot: (released.append(snapshot.time), free(self, snapshot)),
    )
    with Simulation(rig(), engine="fmu") as sim:
        for _ in range(3):
            state = sim.save()
            sim.step()
        assert released == [0.0, 0.1]
        sim.restore(state)
    del state
    assert released == [0.0, 0.1]  # the FMUs took the last one with them


def test_components_that_cannot_be_restored_are_named(rig: Rig) -> None:
    path = rig(more='outside = { fmu = "parts.py:Outside" }')
    with (
        Simulation(path) as sim,
        pytest.raises(InputError, match="the state of outside cannot be saved and restored"),
    ):
        sim.save()
