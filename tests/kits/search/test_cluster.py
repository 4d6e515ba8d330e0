"""Questions asked of a Dask cluster of this machine: the same answers."""

import os

import pytest

from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from tests.kits.campaigns.test_cluster import dask_of

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="workers copy themselves"),
]


@pytest.fixture
def cluster(tmp_path_factory):
    with dask_of(tmp_path_factory.mktemp("dask")) as (address, workers):
        import distributed

        with distributed.Client(address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, workers


@pytest.mark.long
def test_a_question_has_the_same_answer_there(cluster, asked, tmp_path):
    address, _ = cluster
    varied = '[ask.vary]\n"form.a" = { uniform = ["0 m", "9 m"] }\n"form.b" = { uniform = ["0 kg", "9 kg"] }\n'
    settings = "[ask.limits]\nruns = 24\n[ask.worst-case]\nruns = 24\n"
    campaign = asked("sum", "form.y < 5 m", varied + settings)
    for question, names in (
        ("limits", ("results.parquet", "boundary.parquet", "answer.json")),
        ("worst-case", ("results.parquet", "worst-case.toml", "answer.json")),
    ):
        here, there = tmp_path / f"{question}-here", tmp_path / f"{question}-there"
        ask(campaign, question, here, How("direct", jobs=2))
        ask(campaign, question, there, How("direct", cluster=address))
        for name in names:
            assert (here / name).read_bytes() == (there / name).read_bytes(), name
