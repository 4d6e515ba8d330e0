"""Memory of radiated waves (Cummins) as states: a passive network, fitted to a table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from seatrial.errors import InputError
from seatrial.physics.sea.numbers import Array, Complex

MODES = 8
"""Modes of each of the two groups of motions."""
GROUPS = ((0, 2, 4), (1, 3, 5))
"""Surge, heave and pitch; sway, roll and yaw: of a hull with a centre plane, apart."""

_EVALUATIONS = 1000
"""Fewer leave it to rounding how near the fit comes: sharp peaks of catamarans come last."""
_LARGEST_ERROR = 0.2
"""Of a motion: root mean square of what is missed of K_jj over the table, of that of K_jj."""
MOTIONS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
_LARGEST_ACROSS = 0.02
_PAIRS = np.tril_indices(3)
_NETWORK = np.tril_indices(MODES)


@dataclass(frozen=True, eq=False)
class Memory:
    """p' = -R p - W q + B nu, q' = W p; the water holds the hull back with B^T p, N and N m.

    R is symmetric and not negative: the energy (p.p + q.q)/2 only leaves by R, whatever the hull
    does. At constant speed W p = 0, and there is no force. In the frequency domain
    K(i w) = B^T (i w + R + W^2/(i w))^-1 B, which is to be B(w) + i w (A(w) - A_inf) (Ogilvie).
    """

    omega: Array
    """Diagonal of W, rad/s, (modes,)."""
    damping: Array
    """R, rad/s, (modes, modes)."""
    coupling: Array
    """B, (modes, motions)."""
    missed: Array
    """Share of each motion's own K that the fit misses, (motions,): see `_LARGEST_ERROR`."""

    def response(self, omega: Array) -> Complex:
        """Return K(i w), (w, motions, motions)."""
        s = 1j * omega[:, None, None]
        eye = np.eye(len(self.omega))
        impedance = self.damping + s * eye + np.square(self.omega) * eye / s
        return np.asarray(self.coupling.T @ np.linalg.solve(impedance, self.coupling + 0j))


def memories(omega: Array, added: Array, damping: Array, infinite: Array) -> list[Memory]:
    """Return the memory of each of `GROUPS`, fitted in the sense of least squares.

    ``omega`` (w,), rad/s, above 0 and rising; A and B of a panel code, (w, 6, 6); A_inf (6, 6),
    about one point of the centre plane. Raises InputError for tables that no memory gives: of a
    hull without a centre plane, or of A, B and A_inf that do not belong together, so that more
    than a fifth of some motion's K is missed.
    """
    wanted: Complex = damping + 1j * omega[:, None, None] * (added - infinite)
    wanted = 0.5 * (wanted + wanted.transpose(0, 2, 1))
    own = np.abs(np.diagonal(wanted, axis1=1, axis2=2))
    _require_centre_plane(wanted, own)
    # A narrow peak gives its motion little weight: then all motions count by their mean.
    sizes = [np.sqrt(own.max(0)), np.sqrt(2.0) * np.square(own).mean(0) ** 0.25]
    found = [_nearest(omega, wanted, sizes, list(group)) for group in GROUPS]
    if all((memory.missed < _LARGEST_ERROR).all() for memory in found):
        return found
    raise InputError(_misses(found))


def _require_centre_plane(wanted: Complex, own: Array) -> None:
    """Raise InputError if the motions of one group push the hull in the other's."""
    size = _lasting(np.sqrt(own.max(0)))
    across = wanted[:, GROUPS[0]][:, :, GROUPS[1]] / np.outer(
        size[[*GROUPS[0]]], size[[*GROUPS[1]]]
    )
    if np.abs(across).max() > _LARGEST_ACROSS:
        raise InputError(
            "the radiated waves of surge, heave and pitch push the hull sideways: hulls alike on "
            "both sides of y = 0 are needed"
        )


def _lasting(size: Array) -> Array:
    """Return the sizes of motions, infinite for one that radiates nothing."""
    return np.where(size > 1e-6 * size.max(), size, np.inf)


def _nearest(omega: Array, wanted: Complex, sizes: list[Array], group: list[int]) -> Memory:
    """Return the memory of a group, fitted to K over the first of ``sizes`` that is near enough."""
    for size in sizes:
        scale = _lasting(size)[group]
        memory = _fitted(omega, wanted[:, group][:, :, group] / np.outer(scale, scale))
        if (memory.missed < _LARGEST_ERROR).all():
            break
    return replace(memory, coupling=memory.coupling * np.where(np.isfinite(scale), scale, 0.0))


def _misses(found: list[Memory]) -> str:
    """Return what is wrong, with the share that is missed of each motion."""
    missed = {
        motion: share
        for memory, group in zip(found, GROUPS, strict=True)
        for motion, share in zip(group, memory.missed.tolist(), strict=True)
    }
    shares = ", ".join(f"{name} {missed[motion]:.0%}" for motion, name in enumerate(MOTIONS))
    return (
        f"added mass and damping do not belong together: a memory misses {shares} of them, and "
        f"{_LARGEST_ERROR:.0%} of each is allowed; is the added mass at infinite frequency of the "
        "same hull, are the frequencies those of its radiation, are irregular frequencies removed?"
    )


def _fitted(omega: Array, wanted: Complex) -> Memory:
    """Return the memory of one group; ``wanted`` K, each motion's largest about 1."""
    network = _Network(omega, wanted)
    first = np.log(np.geomspace(0.6, 2.5, -(-MODES // 3)).repeat(3)[:MODES])
    coupling = 0.7 * np.tile(np.eye(3), (-(-MODES // 3), 1))[:MODES]
    root = np.diag(np.sqrt(0.8 * np.exp(first)))
    start = np.concatenate([first, coupling.ravel(), root[_NETWORK]])
    # MINPACK: tiny problems must not wait for the threads of a linear algebra library.
    result = least_squares(
        network.error,
        start,
        network.jacobian,
        method="lm",
        x_scale="jac",
        max_nfev=_EVALUATIONS,
    )
    memory = network.memory(result.x)
    own, off = (
        np.square(np.abs(np.diagonal(k, axis1=1, axis2=2))).mean(0)
        for k in (wanted, memory.response(omega) - wanted)
    )
    # A motion that radiates nothing misses nothing.
    missed = np.sqrt(np.divide(off, own, out=np.zeros(3), where=own > 0.0))
    return replace(memory, missed=missed)


class _Network:
    """Error of a memory against a table, and its derivatives, for least squares.

    Parameters: log of the modes' frequencies over ``middle``, B, and L of R = L L^T.
    """

    def __init__(self, omega: Array, wanted: Complex) -> None:
        self.wanted = wanted[:, _PAIRS[0], _PAIRS[1]]
        self.middle = float(omega[np.argmax(np.trace(wanted.real, axis1=1, axis2=2))])
        self.s = (1j * omega / self.middle)[:, None, None]

    def memory(self, parameters: Array) -> Memory:
        """Return the memory that the parameters say."""
        w, coupling, root = self._parts(parameters)
        scale = self.middle
        return Memory(w * scale, root @ root.T * scale, coupling * np.sqrt(scale), np.zeros(3))

    def error(self, parameters: Array) -> Array:
        """Return what is off, real and imaginary."""
        w, coupling, root = self._parts(parameters)
        found = coupling.T @ self._motion(w, coupling, root)
        off = (found[:, _PAIRS[0], _PAIRS[1]] - self.wanted).ravel()
        return np.concatenate([off.real, off.imag])

    def jacobian(self, parameters: Array) -> Array:
        """Return the derivatives of `error`: dK = dB^T X + X^T dB - X^T dZ X, X = Z^-1 B."""
        w, coupling, root = self._parts(parameters)
        x = self._motion(w, coupling, root)
        i, j = _PAIRS
        by_w = (-2.0 * np.square(w)[:, None] / self.s) * x[:, :, i] * x[:, :, j]
        here = (np.arange(3)[:, None] == i)[None, None], (np.arange(3)[:, None] == j)[None, None]
        by_coupling = here[0] * x[:, :, None, j] + here[1] * x[:, :, None, i]
        y = root.T @ x
        a, b = _NETWORK
        by_root = -(x[:, a][:, :, i] * y[:, b][:, :, j] + y[:, b][:, :, i] * x[:, a][:, :, j])
        pairs = len(i)
        columns = [by_w, by_coupling.reshape(len(x), -1, pairs), by_root]
        rows = np.concatenate(columns, 1).transpose(0, 2, 1).reshape(len(x) * pairs, -1)
        return np.concatenate([rows.real, rows.imag])

    def _parts(self, parameters: Array) -> tuple[Array, Array, Array]:
        root = np.zeros((MODES, MODES))
        root[_NETWORK] = parameters[4 * MODES :]
        coupling = parameters[MODES : 4 * MODES].reshape(MODES, 3)
        return np.exp(parameters[:MODES]), coupling, root

    def _motion(self, w: Array, coupling: Array, root: Array) -> Complex:
        eye = np.eye(MODES)
        impedance = root @ root.T + self.s * eye + np.square(w) * eye / self.s
        return np.asarray(np.linalg.solve(impedance, coupling + 0j))
