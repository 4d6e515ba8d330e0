"""Which transport a link takes, without a workspace of ROS; with one: test_rclpy.py."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.ros2.joining import join


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """A workspace whose rclpy is of another Python."""
    package = tmp_path / "rclpy"
    package.mkdir()
    (package / "__init__.py").write_text("raise ImportError('rclpy is of Python 3.10')\n")
    listed = tmp_path / "share/ament_index/resource_index/packages"
    listed.mkdir(parents=True)
    (listed / "rmw_fastrtps_cpp").touch()
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")


def test_a_workspace_of_another_python_leaves_dds(broken, domain, caplog):
    joined = join(domain, "/seatrial")
    try:
        assert joined.title == "cyclonedds"
    finally:
        joined.close()
    assert "rclpy cannot be used: rclpy is of Python 3.10: the link speaks DDS" in caplog.text


def test_why_rclpy_cannot_be_used_is_said(broken, domain, monkeypatch):
    with pytest.raises(InputError, match=r"rclpy cannot be used: rclpy is of Python 3\.10: source"):
        join(domain, "/seatrial", "rclpy")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    with pytest.raises(InputError, match="no sourced workspace has rmw_zenoh_cpp"):
        join(domain, "/seatrial", "rclpy")


def test_a_middleware_that_neither_has_is_refused(broken, domain, monkeypatch):
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    with pytest.raises(InputError, match="RMW_IMPLEMENTATION: unknown middleware 'rmw_zenoh_cpp'"):
        join(domain, "/seatrial")
