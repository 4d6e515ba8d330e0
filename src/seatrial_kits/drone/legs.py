"""Four feet on a deck that moves: forces on what stands on them and on the deck."""

from __future__ import annotations

from typing import Any

import casadi as ca

from seatrial.physics.contact import friction, hunt_crossley

_SIGNS = ((1, -1), (1, 1), (-1, -1), (-1, 1))
_THICKNESS = 0.05
"""What is farther below the deck than this, m, is under it, not on it."""


class Legs:
    """Forces of the feet: ``force`` in the deck's axes, ``moment`` on the drone in its own,
    ``on_deck`` the moment of the former about the craft's origin, N.m."""

    def __init__(self, x: Any, u: Any, p: Any, own: Any, deck: Any, place: Any) -> None:
        self.force = self.moment = self.on_deck = ca.DM.zeros(3)
        self.slip = ca.DM.zeros(3)
        self.normals = []
        velocity = deck.T @ x.velocity - u.deck_velocity
        for ahead, aside in _SIGNS:
            arm = ca.vertcat(ahead * p.feet[0], aside * p.feet[1], p.feet[2])
            foot = place + deck.T @ own @ arm
            turned = deck.T @ own @ ca.cross(x.rates, arm)
            v = velocity + turned - ca.cross(u.deck_rates, foot)
            depth = foot[2] - p.pad[2]
            normal = hunt_crossley(depth, v[2], p.stiffness, p.damping)
            normal *= inside(foot, p.deck_size) * (depth < _THICKNESS)
            drag = friction(normal, (v[0], v[1]), p.friction, p.slip_speed)
            force = ca.vertcat(*drag, -normal)
            self.normals.append(normal)
            self.force += force
            self.moment += ca.cross(arm, own.T @ deck @ force)
            self.on_deck += ca.cross(foot, force)
            self.slip += v / 4
        self.total = sum(self.normals)


def inside(place: Any, size: Any) -> Any:
    """Return 1 for a place above the deck, else 0."""
    return (ca.fabs(place[0]) <= size[0] / 2) * (ca.fabs(place[1]) <= size[1] / 2)
