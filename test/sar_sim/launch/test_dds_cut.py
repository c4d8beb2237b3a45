"""Which packets the cut of DDS drops; with a network of its own, that it does."""

import socket
import subprocess
import sys

import pytest

from sar_sim.launch.dds_cut import (
    DROP,
    IN_OWN_NETWORK,
    PASS,
    DdsCut,
    dds_ports,
    drop_program,
    own_network_possible,
)


def run(program, frame):
    """Return what a classic BPF program, as tc takes it, says of an Ethernet frame."""
    count, *words = program.split(",")
    steps = [tuple(int(part) for part in word.split()) for word in words]
    assert len(steps) == int(count)
    at = value = 0
    while True:
        code, yes, no, k = steps[at]
        at += 1
        if code == 0x28:
            value = int.from_bytes(frame[k : k + 2])
        elif code == 0x30:
            value = frame[k]
        elif code == 0x06:
            return k
        else:
            true = {0x15: value == k, 0x35: value >= k, 0x25: value > k}[code]
            at += yes if true else no


def frame(port, *, kind=0x0800, protocol=17):
    data = bytearray(60)
    data[12:14] = kind.to_bytes(2)
    data[23] = protocol
    data[36:38] = port.to_bytes(2)
    return bytes(data)


@pytest.mark.parametrize("domain", [0, 1, 77, 101])
def test_dds_is_dropped_and_nothing_else(domain):
    first, last = dds_ports({"ROS_DOMAIN_ID": str(domain)})
    assert (first, last) == (7400 + 250 * domain, 7649 + 250 * domain)
    program = drop_program(first, last)
    for port in range(6900, 33000):
        dds = 7000 <= port < 7400 or first <= port <= last
        assert run(program, frame(port)) == (DROP if dds else PASS), port
    assert run(program, frame(first, protocol=6)) == PASS
    assert run(program, frame(first, kind=0x86DD)) == PASS
    assert dds_ports({}) == (7400, 7649)


def test_it_is_refused_in_the_machines_own_network(monkeypatch):
    monkeypatch.setattr(socket, "if_nameindex", lambda: [(1, "lo"), (2, "eth0")])
    with pytest.raises(OSError, match="network of its own"):
        DdsCut()


SENT = """
import socket
from sar_sim.launch.dds_cut import DdsCut
def heard(port):
    with socket.socket(type=socket.SOCK_DGRAM) as to, socket.socket(type=socket.SOCK_DGRAM) as me:
        to.bind(("127.0.0.1", port))
        to.settimeout(0.3)
        me.sendto(b"x", ("127.0.0.1", port))
        try:
            return to.recv(1) == b"x"
        except TimeoutError:
            return False
cut = DdsCut()
print(heard(7410), heard(14550))
cut.off()
print(heard(7410), heard(14550))
cut.on()
print(heard(7410), heard(14550))
"""


@pytest.mark.skipif(not own_network_possible(), reason="unshare -rn or tc: not allowed or not here")
def test_in_a_network_of_its_own_it_cuts_dds_and_lets_it_through_again():
    done = subprocess.run(
        [*IN_OWN_NETWORK, sys.executable, "-c", SENT],
        env={"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "PYTHONPATH": ":".join(sys.path)},
        capture_output=True,
        text=True,
        timeout=30,
        check=True,
    )
    assert done.stdout.split("\n")[:3] == ["True True", "False True", "True True"]
