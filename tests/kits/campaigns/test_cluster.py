"""A Dask cluster of this machine: the same table, and nothing lost or twice when a worker dies."""

import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.shipment import packed, unpacked
from seatrial_kits.campaigns.sweep import How, run_sweep

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="workers copy themselves"),
]
CAMPAIGN = """
trials = ["hydrone-open-landing"]
keep = "failed"
[set]
"downwash.pad" = "diagonal-aft"
stop = "10 s"
[design]
kind = "monte-carlo"
count = 24
[design.vary]
"downwash.mass" = { uniform = ["1 kg", "12 kg"] }
"""


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@contextmanager
def dask_of(folder: Path, scheme: str = "tcp", *options: str):
    """Yield the address of a scheduler, and its two workers' processes; without a nanny."""
    address = f"{scheme}://127.0.0.1:{(port := free_port())}"
    dask = [sys.executable, "-m", "dask"]
    at = ["--host", "127.0.0.1" if scheme == "tcp" else f"{scheme}://127.0.0.1"]
    scheduler = [*dask, "scheduler", *at, "--port", str(port), "--no-dashboard", *options]
    worker = [*dask, "worker", address, *at, "--nthreads", "1", "--no-nanny", *options]
    worker += ["--no-dashboard", "--local-directory", str(folder)]

    def started(command):
        return subprocess.Popen(
            command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    first = started(scheduler)
    workers = [started(worker), started(worker)]
    try:
        yield address, workers
    finally:
        for process in (*workers, first):
            process.terminate()
            process.wait(timeout=30)


@pytest.fixture
def cluster(tmp_path_factory):
    with dask_of(tmp_path_factory.mktemp("dask")) as (address, workers):
        import distributed

        with distributed.Client(address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, workers


@pytest.fixture
def campaign(tmp_path):
    (tmp_path / "landings.toml").write_text(CAMPAIGN, "utf-8")
    return load_campaign(str(tmp_path / "landings.toml"))


def content(folder: Path) -> dict[str, bytes]:
    """Return what does not depend on who ran the cases, or when."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in files
        if path.name not in ("timing.parquet", "timing.json")
    }


@pytest.mark.long
def test_it_leaves_what_one_machine_leaves(cluster, campaign, tmp_path):
    address, _ = cluster
    run_sweep(campaign, tmp_path / "here", How("direct", jobs=2))
    summary = run_sweep(campaign, tmp_path / "there", How("direct", cluster=address))
    assert 0 < summary.failed < summary.ended == 24
    assert content(tmp_path / "here") == content(tmp_path / "there")


@pytest.mark.long
def test_a_worker_that_is_killed_loses_no_case(cluster, campaign, tmp_path):
    address, workers = cluster
    ended = []

    def done(_case, case):
        ended.append(case.number)
        if len(ended) == 6:
            workers[0].send_signal(signal.SIGKILL)

    run_sweep(campaign, tmp_path / "there", How("direct", cluster=address), done=done)
    assert ended == [*range(24)]
    run_sweep(campaign, tmp_path / "here", How("direct", jobs=2))
    assert content(tmp_path / "here") == content(tmp_path / "there")
    assert list(pd.read_parquet(tmp_path / "there/results.parquet")["case"]) == [*range(1, 25)]


@pytest.mark.long
def test_files_of_a_user_s_own_travel(cluster, campaign, tmp_path):
    address, _ = cluster
    rig = Path(campaign.trials[0].rig.read_from.path).read_text("utf-8")
    trial = Path(campaign.trials[0].read_from.path).read_text("utf-8")
    (tmp_path / "own.toml").write_text(rig, "utf-8")
    (tmp_path / "t.toml").write_text(trial.replace("hydrone-open-loop", "own.toml"), "utf-8")
    text = CAMPAIGN.replace("hydrone-open-landing", "t.toml")
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    archive, name = packed(load_campaign(str(tmp_path / "mine.toml"))), tmp_path.name
    tmp_path.rename(tmp_path.with_name("moved"))  # whoever looks here finds nothing
    shipped, top = unpacked(archive)
    tmp_path.with_name("moved").rename(tmp_path)
    assert shipped.read_from.path.parent == top
    assert name not in str(top)
    assert shipped.trials[0].rig.read_from.path == top / "own.toml"
    run_sweep(shipped, tmp_path / "out", How("direct", cluster=address))
    assert len(pd.read_parquet(tmp_path / "out/results.parquet")) == 24


def test_an_address_without_a_scheduler_is_said(campaign, tmp_path, monkeypatch):
    monkeypatch.setattr("seatrial_kits.campaigns.cluster._WAIT_S", 1)
    how = How("direct", cluster=f"tcp://127.0.0.1:{free_port()}")
    with pytest.raises(InputError, match="there is no scheduler"):
        run_sweep(campaign, tmp_path / "out", how)
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_tls_with_certificates_of_one_authority(campaign, tmp_path):
    """Made by OpenSSL; without the client's own, or of another authority, nobody is let in."""
    import dask
    import distributed  # noqa: F401  # its settings are there before they are set

    run = lambda *command: subprocess.run(["openssl", *command], check=True, capture_output=True)  # noqa: E731
    for name in ("one", "other"):
        key, certificate = tmp_path / f"{name}.key", tmp_path / f"{name}.pem"
        pair = ("-keyout", str(key), "-out", str(certificate))
        run("req", "-x509", "-newkey", "rsa:2048", "-nodes", *pair, "-subj", f"/CN={name}")

    def settings(name):
        pem, key = str(tmp_path / f"{name}.pem"), str(tmp_path / f"{name}.key")
        tls = "distributed.comm.tls."
        return {f"{tls}ca-file": pem, f"{tls}client.cert": pem, f"{tls}client.key": key}

    (tmp_path / "dask").mkdir()
    options = ("--tls-ca-file", str(tmp_path / "one.pem"), "--tls-cert", str(tmp_path / "one.pem"))
    options += ("--tls-key", str(tmp_path / "one.key"))
    with dask_of(tmp_path / "dask", "tls", *options) as (address, _):
        with dask.config.set(settings("one")):
            summary = run_sweep(campaign, tmp_path / "out", How("direct", cluster=address))
        assert summary.ended == 24
        with pytest.raises(InputError, match=r"needs authority, certificate and key"):
            run_sweep(campaign, tmp_path / "none", How("direct", cluster=address))
        with dask.config.set(settings("other")), pytest.raises(InputError, match="no scheduler at"):
            run_sweep(campaign, tmp_path / "other", How("direct", cluster=address))


@pytest.mark.parametrize("answer", [b"", b"\xff" * 64, None])
def test_a_peer_that_is_no_scheduler_is_said(campaign, tmp_path, monkeypatch, answer):
    """Closes at once, sends lengths that nobody has, or waits for more, as a web server does."""
    monkeypatch.setattr("seatrial_kits.campaigns.cluster._WAIT_S", 2)
    monkeypatch.setattr("seatrial_kits.campaigns.cluster._LATE_S", 2)
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken = []

        def serve():
            while True:
                try:
                    taken.append(server.accept()[0])
                except OSError:
                    return
                if answer is not None:
                    taken[-1].sendall(answer)
                    taken[-1].close()

        threading.Thread(target=serve, daemon=True).start()
        how = How("direct", cluster=f"tcp://127.0.0.1:{server.getsockname()[1]}")
        with pytest.raises(InputError, match="there is no scheduler"):
            run_sweep(campaign, tmp_path / "out", how)
        server.shutdown(socket.SHUT_RDWR)
    for one in taken:
        one.close()
    assert not (tmp_path / "out").exists()


def test_a_limit_holds_on_a_cluster(cluster, tmp_path):
    address, _ = cluster
    (tmp_path / "slow.toml").write_text(
        CAMPAIGN.replace("count = 24", "count = 2").replace("10 s", "1000 s"), "utf-8"
    )
    slow = load_campaign(str(tmp_path / "slow.toml"), limit={"wall": "300 ms"})
    summary = run_sweep(slow, tmp_path / "out", How("direct", cluster=address, keep="none"))
    assert (summary.ended, summary.broken) == (2, 2)
    errors = pd.read_parquet(tmp_path / "out/results.parquet")["error"]
    assert errors.str.contains("beyond its limit of 0.3 s of wall time").all()
