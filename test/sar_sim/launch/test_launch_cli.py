"""The launcher's options that reach its nodes by the environment."""

import os

import pytest

from sar_estimator.common.priorities import OFF
from sar_sim.launch import launch_cli


@pytest.mark.parametrize("given", [[], ["--no-priorities"]])
def test_priorities_are_left_alone_where_that_is_asked_for(monkeypatch, given):
    """What is told to nodes is seen when they would be watched, before any is started."""
    name, off = OFF
    monkeypatch.setenv(name, "1")
    monkeypatch.setattr(launch_cli, "prepare", lambda _: launch_cli.argparse.Namespace(specs=[]))

    def watch(_uavs):
        raise InterruptedError

    monkeypatch.setattr(launch_cli, "start_watching", watch)
    with pytest.raises(InterruptedError):
        launch_cli.main(given)
    assert (os.environ[name] == off) is bool(given)
