"""Reference integrations of the Hydrone's open landing: ``python -m benchmarks.integrators``.

20 s of the trial `hydrone-open-landing` at tolerances of 1e-6, in two pieces about the contact:
methods of SciPy with the right-hand side called through CasADi with NumPy's arrays, bound to them
once, as `Plant.reference` does, and bound as machine code; and SUNDIALS' CVODES,
`Plant.reference(method="CVODES")`. In turn, for some rounds, processor time; errors against DOP853
at 1e-12. ``--write`` puts the table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import platform
import statistics
from collections.abc import Callable
from time import process_time
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from seatrial.fmi.compiled_functions import compiled_function
from seatrial.model.expressions import bind
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from .history import noted
from .pages import write_measured

TOLERANCE = 1e-6
END = 20.0
NUMPY, BOUND, COMPILED = "arrays of NumPy", "bound once", "compiled, bound once"
CVODES = "CVODES"
YARDSTICK = f"LSODA, {NUMPY}"


class Landing:
    """The hull, the drone's load on it, and ways to integrate them."""

    def __init__(self) -> None:
        system = assemble(load_rig("hydrone-open-loop"), "direct")
        system.set("downwash.pad", "diagonal-aft", "benchmark")
        for name in ("hull", "downwash"):
            instance = system.parts[name].instance
            given = system.parts[name].given
            instance.set_start({key: one.value for key, one in given.items()})
            instance.initialise(0.0, END)
        self.hull: Any = system.parts["hull"].instance.component
        self.load: Any = system.parts["downwash"].instance.component
        self.pieces = ((0.0, self.load.contact_time), (self.load.contact_time, END))
        model = self.hull.compiled()
        self.rhs, self.p = model.rhs, self.hull._stacked_p()
        self.start, self.u = self.hull._start_state(), self.hull._stacked_u(None)
        self.places = [self.hull._place_of(name) for name in ("force_1", "moment_1")]

    def wrench(self, t: float, x: Any, u: Any) -> None:
        for place, value in zip(self.places, self.load.wrench(t, x[3:6].tolist()), strict=True):
            u[place] = value

    def through_numpy(self, t: float, x: Any) -> Any:
        u = self.u.copy()
        self.wrench(t, x, u)
        return np.asarray(self.rhs(x, u, self.p)).ravel()

    def bound(self, rhs: Any) -> Callable[[float, Any], Any]:
        """Return the slope by a function of CasADi that finds its arguments where they are."""
        state, u, dx = self.start.copy(), self.u.copy(), np.zeros(len(self.start))
        buffer, evaluate = bind(rhs, [state, u, self.p], dx)

        def slope(t: float, x: Any, _kept: Any = buffer) -> Any:
            state[:] = x
            self.wrench(t, x, u)
            evaluate()
            return dx.copy()

        return slope

    def scipy(self, slope: Callable[[float, Any], Any], method: str, tolerance: float) -> Any:
        x = self.start
        for piece in self.pieces:
            run = solve_ivp(slope, piece, x, method=method, rtol=tolerance, atol=tolerance)
            x = run.y[:, -1]
        return x

    def inputs(self, t: Any, x: Any) -> dict[str, Any]:
        """The load as an expression: `Downwash` at landing, without a ground effect."""
        load, s = self.load, t / self.load.contact_time
        z0, weight = load.initial_height, load.mass * load.gravity
        height = z0 * (1.0 - 10.0 * s**3 + 15.0 * s**4 - 6.0 * s**5)
        climb = z0 * (-60.0 * s + 180.0 * s**2 - 120.0 * s**3) / load.contact_time**2
        share = ca.exp(-((height / load.wake_length) ** 2))
        flying = share * load.mass * (load.gravity + climb)
        size = ca.if_else(t < load.contact_time, flying, weight)
        sp, cp = ca.sin(x.attitude[0]), ca.cos(x.attitude[0])
        st, ct = ca.sin(x.attitude[1]), ca.cos(x.attitude[1])
        force = size * ca.vertcat(-st, ct * sp, ct * cp)
        return {"force_1": force, "moment_1": ca.cross(ca.DM(load.pad), force)}

    def sundials(self) -> Any:
        return self.hull.reference(
            [0.0, END], self.inputs, [self.pieces[0][1]],
            method="CVODES", rtol=TOLERANCE, atol=TOLERANCE,
        ).x[-1]  # fmt: skip


def measure(rounds: int) -> dict[str, tuple[list[float], float]]:
    """Return, of each way, the processor times, s, and its error."""
    landing = Landing()
    bound, compiled = landing.bound(landing.rhs), landing.bound(compiled_function(landing.rhs))
    exact = landing.scipy(bound, "DOP853", 1e-12)
    ways: dict[str, Callable[[], Any]] = {}
    for method in ("RK45", "DOP853", "LSODA"):
        slopes = {NUMPY: landing.through_numpy, BOUND: bound, COMPILED: compiled}
        for name, slope in slopes.items():
            ways[f"{method}, {name}"] = lambda m=method, s=slope: landing.scipy(s, m, TOLERANCE)
    ways[CVODES] = landing.sundials
    found: dict[str, tuple[list[float], float]] = {}
    for _ in range(rounds):
        for name, way in ways.items():
            begun = process_time()
            x = way()
            taken = process_time() - begun
            found.setdefault(name, ([], float(np.abs(x - exact).max())))[0].append(taken)
    return found


def table(found: dict[str, tuple[list[float], float]]) -> str:
    """Return the table in Markdown."""
    rows = [
        f"| integrator, right-hand side | ms | ratio to {YARDSTICK} | largest error, SI |",
        "| --- | --- | --- | --- |",
    ]
    for name, (times, error) in found.items():
        ratios = [a / b for a, b in zip(times, found[YARDSTICK][0], strict=True)]
        ratio = f"{statistics.median(ratios):.3g} ({min(ratios):.2g} to {max(ratios):.2g})"
        rows.append(f"| {name} | {1e3 * statistics.median(times):.3g} | {ratio} | {error:.1e} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    options = parser.parse_args()
    found = measure(options.rounds)
    text = f"Python {platform.python_version()}, {options.rounds} rounds.\n\n{table(found)}"
    print(text)
    if options.write:
        base = statistics.median(found[YARDSTICK][0])
        ratios = {f"{n} to {YARDSTICK}": statistics.median(t) / base for n, (t, _) in found.items()}
        text = f"{text}\n\n{noted('integrators', ratios)}"
        write_measured("performance.md", text, "measured of the integrators")


if __name__ == "__main__":
    main()
