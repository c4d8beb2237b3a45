"""How nodes end."""

import os
import signal
import subprocess
import sys
import time

import pytest

HANGING = """
import sys, time
import rclpy
from rclpy.node import Node
from sar_estimator import node_support

def hang(node):
    print("spinning", flush=True)
    while True:
        try:
            time.sleep(60.0)
        except KeyboardInterrupt:
            pass

node_support.PATIENCE_S = 0.5
rclpy.spin = hang
sys.exit(node_support.run_node("hanging", lambda: Node("hanging")))
"""


@pytest.mark.graph
@pytest.mark.timeout(60)
@pytest.mark.parametrize("trapped", ["", "trap '' INT; "], ids=["alone", "in_the_background"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_node_ends_when_asked_whatever_hangs_in_it(number, trapped):
    """A shell has what it starts in the background ignore SIGINT."""
    process = subprocess.Popen(
        ["bash", "-c", f'{trapped}exec "$@"', "bash", sys.executable, "-c", HANGING],
        stdout=subprocess.PIPE,
        env=dict(os.environ, ROS_DOMAIN_ID="96"),
        text=True,
    )
    try:
        assert process.stdout.readline() == "spinning\n"
        time.sleep(0.3)
        assert process.poll() is None
        process.send_signal(number)
        assert process.wait(timeout=15.0) == 0
    finally:
        process.kill()
        process.wait()
