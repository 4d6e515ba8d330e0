"""Dependency order: strongly connected groups, sorted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import TypeVar

Node = TypeVar("Node")


def ordered_groups(depends_on: Mapping[Node, Sequence[Node]]) -> list[list[Node]]:
    """Return the nodes in dependency order, those of one loop together in one group.

    ``depends_on`` maps each node to the nodes that must come before it; nodes that are only
    named as dependencies are included. Equal inputs give equal orders.
    """
    nodes = list(dict.fromkeys([*depends_on, *(d for ds in depends_on.values() for d in ds)]))
    try:
        order = TopologicalSorter({n: depends_on.get(n, ()) for n in nodes}).static_order()
        return [[node] for node in order]
    except CycleError:
        pass
    label = _strongly_connected(nodes, depends_on)
    members: dict[int, list[Node]] = {}
    for node in nodes:
        members.setdefault(label[node], []).append(node)
    graph: dict[int, dict[int, None]] = {group: {} for group in members}
    for node, dependencies in depends_on.items():
        for dependency in dependencies:
            if label[dependency] != label[node]:
                graph[label[node]][label[dependency]] = None
    return [members[group] for group in TopologicalSorter(graph).static_order()]


def loops_on_itself(group: list[Node], depends_on: Mapping[Node, Iterable[Node]]) -> bool:
    """Say if a group is a loop: of several nodes, or of one that depends on itself."""
    return len(group) > 1 or group[0] in depends_on.get(group[0], ())


def unrolled(loop: Sequence[Node], depends_on: Mapping[Node, Sequence[Node]]) -> list[Node]:
    """Return the nodes of a loop, each after those it depends on as far as that can be.

    >>> unrolled(["c", "b", "a"], {"a": ["c"], "b": ["a"], "c": ["b"]})
    ['a', 'b', 'c']
    """
    waiting, order = set(loop), []
    for root in loop:
        path = []
        if root in waiting:
            waiting.remove(root)
            path.append((root, iter(depends_on.get(root, ()))))
        while path:
            node, dependencies = path[-1]
            following = next((d for d in dependencies if d in waiting), None)
            if following is None:
                order.append(node)
                path.pop()
            else:
                waiting.remove(following)
                path.append((following, iter(depends_on.get(following, ()))))
    return order


def _strongly_connected(
    nodes: Sequence[Node], depends_on: Mapping[Node, Iterable[Node]]
) -> dict[Node, int]:
    """Return the number of each node's strongly connected component."""
    import numpy as np
    from scipy.sparse import coo_array  # slow to import, and most rigs have no loop
    from scipy.sparse.csgraph import connected_components

    index = {node: i for i, node in enumerate(nodes)}
    pairs = [(index[n], index[d]) for n, ds in depends_on.items() for d in ds]
    rows, columns = zip(*pairs, strict=True)
    shape = (len(nodes), len(nodes))
    graph = coo_array((np.ones(len(pairs), bool), (rows, columns)), shape)
    _, labels = connected_components(graph, directed=True, connection="strong")
    return {node: int(labels[i]) for node, i in index.items()}
