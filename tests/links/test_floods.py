"""A flood in a run: it is a note of the run, once, and the run keeps its pace."""

import socket
import threading

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

RIG = """\
step = "10 ms"
[components]
port = { fmu = "serial-gateway", set = { links = "tcpout:127.0.0.1:PORT" } }
quiet = { fmu = "serial-gateway" }
"""
TRIAL = 'rig = "rig.toml"\nstop = "0.3 s"\n[real_time]\n'


def test_a_flood_is_noted_once(write, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(30.0)
        write("rig.toml", RIG.replace("PORT", str(server.getsockname()[1])))

        def flood():
            connection, _ = server.accept()
            with connection:
                connection.settimeout(30.0)
                try:
                    while True:
                        connection.sendall(bytes(1 << 16))
                except OSError:
                    pass  # the run is over

        thread = threading.Thread(target=flood)
        thread.start()
        trial = load_trial(str(write("trial.toml", TRIAL)))
        result = run_trial(trial, tmp_path / "run", engine="direct")
        thread.join()
    assert result.status == "complete"
    notes = [note for note in result.notes if "brought more than one takes in" in note]
    assert len(notes) == 1
    assert notes[0].startswith("port: in ")
