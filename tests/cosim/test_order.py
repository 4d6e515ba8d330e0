"""The order of feed-through outputs against brute-force strongly connected components."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from seatrial.sim.order import loops_on_itself, ordered_groups

Graph = dict[str, list[str]]


@st.composite
def graphs(draw) -> Graph:
    """Up to ten nodes, some named as dependencies only, with loops of any kind."""
    names = [f"n{i}" for i in range(draw(st.integers(0, 10)))]
    if not names:
        return {}
    keys = draw(st.lists(st.sampled_from(names), unique=True))
    dependencies = st.lists(st.sampled_from(names), max_size=draw(st.integers(0, 4)))
    return {key: draw(dependencies) for key in keys}


def reach(graph: Graph) -> dict[str, set[str]]:
    """Return, by brute force, what each node depends on, directly or not, itself included."""
    nodes = {*graph, *(d for ds in graph.values() for d in ds)}
    found = {node: {node} for node in nodes}
    for _ in nodes:
        for node in nodes:
            for near in list(found[node]):
                found[node] |= set(graph.get(near, ()))
    return found


@pytest.mark.slow
@given(graphs())
def test_groups_are_the_strongly_connected_components(graph: Graph) -> None:
    depends = reach(graph)
    groups = ordered_groups(graph)
    assert sorted(n for group in groups for n in group) == sorted(depends)  # each once
    expected = {frozenset(m for m in depends[n] if n in depends[m]) for n in depends}
    assert {frozenset(group) for group in groups} == expected


@given(graphs())
def test_dependencies_come_before_what_depends_on_them(graph: Graph) -> None:
    place = {n: i for i, group in enumerate(ordered_groups(graph)) for n in group}
    for node, dependencies in graph.items():
        for dependency in dependencies:
            same = node in reach(graph)[dependency]
            assert place[dependency] == place[node] if same else place[dependency] < place[node]


@given(graphs())
def test_order_does_not_change_from_call_to_call(graph: Graph) -> None:
    first = ordered_groups(graph)
    assert first == ordered_groups(dict(graph))
    assert first == ordered_groups({k: tuple(v) for k, v in graph.items()})


@pytest.mark.parametrize(("size", "edges"), [(60, 50), (60, 120), (200, 220), (200, 2000)])
def test_large_graphs_against_scipy(size: int, edges: int) -> None:
    rng = np.random.default_rng(size + edges)
    matrix = np.zeros((size, size), dtype=bool)
    matrix[rng.integers(0, size, edges), rng.integers(0, size, edges)] = True
    graph = {i: np.flatnonzero(matrix[i]).tolist() for i in range(size)}
    count, labels = connected_components(matrix, connection="strong")
    groups = ordered_groups(graph)
    assert len(groups) == count
    assert {frozenset(g) for g in groups} == {
        frozenset(np.flatnonzero(labels == label).tolist()) for label in range(count)
    }
    place = {n: i for i, group in enumerate(groups) for n in group}
    assert all(place[d] <= place[n] for n, ds in graph.items() for d in ds)


def test_a_long_chain_and_a_long_loop_need_no_recursion() -> None:
    n = 3000
    chain = {i: [i + 1] for i in range(n)}
    assert ordered_groups(chain) == [[i] for i in reversed(range(n + 1))]
    loop = {**chain, n: [0]}
    assert ordered_groups(loop) == [list(range(n + 1))]


@pytest.mark.slow
def test_order_is_the_same_whatever_the_hash_seed() -> None:
    code = (
        "from seatrial.sim.order import ordered_groups\n"
        "g = {f'p{i}.y{i % 3}': [f'p{(i * 7 + j) % 40}.y{(i + j) % 3}' for j in range(i % 4)] for i in range(40)}\n"
        "print(ordered_groups(g))"
    )
    printed = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1", "2")
    }
    assert len(printed) == 1
    assert "p39" in printed.pop()


def test_within_a_group_nodes_stand_as_they_were_named() -> None:
    assert ordered_groups({"c": ["a"], "a": ["b"], "b": ["c"], "d": ["c"]}) == [
        ["c", "a", "b"],
        ["d"],
    ]


@pytest.mark.parametrize(
    ("graph", "loops"),
    [
        ({"a": []}, [False]),
        ({"a": ["a"]}, [True]),
        ({"a": ["b"]}, [False, False]),
        ({"a": ["b"], "b": ["a"]}, [True]),
        ({"a": ["b", "c"], "b": ["b"]}, [True, False, False]),
        ({}, []),
    ],
)
def test_which_groups_are_loops(graph: Graph, loops: list[bool]) -> None:
    assert [loops_on_itself(group, graph) for group in ordered_groups(graph)] == loops
