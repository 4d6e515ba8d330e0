"""In which order feed-through outputs must be read again: strongly connected groups, sorted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import TypeVar

Node = TypeVar("Node")


def ordered_groups(depends_on: Mapping[Node, Iterable[Node]]) -> list[list[Node]]:
    """Return the nodes in dependency order, those of one loop together in one group.

    ``depends_on`` maps each node to the nodes that must come before it; nodes that are only
    named as dependencies count too. Equal inputs give equal orders.
    """
    member: dict[Node, Node] = {}  # node -> representative of its group
    nodes = list(dict.fromkeys([*depends_on, *(d for ds in depends_on.values() for d in ds)]))
    for node in nodes:
        member[node] = node
    while True:
        graph: dict[Node, dict[Node, None]] = {member[n]: {} for n in nodes}
        for node, dependencies in depends_on.items():
            for dependency in dependencies:
                if member[dependency] != member[node]:
                    graph[member[node]][member[dependency]] = None
        try:
            order = list(TopologicalSorter(graph).static_order())
        except CycleError as error:
            # Merge the loop that was found into one group and look again.
            loop = set(error.args[1])
            first = next(n for n in nodes if member[n] in loop)
            merged = member[first]
            member = {n: merged if m in loop else m for n, m in member.items()}
            continue
        return [[n for n in nodes if member[n] == group] for group in order]


def loops_on_itself(group: list[Node], depends_on: Mapping[Node, Iterable[Node]]) -> bool:
    """Say if a group is a loop: of several nodes, or of one that depends on itself."""
    return len(group) > 1 or group[0] in depends_on.get(group[0], ())
