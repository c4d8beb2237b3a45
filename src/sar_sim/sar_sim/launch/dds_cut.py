"""Cuts the DDS traffic of this machine, in a network of its own (Linux: ``unshare -rn``)."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
from collections.abc import Mapping

FIRST_PORT = 7400
PORTS_A_DOMAIN = 250
FAST_DDS_PORT = 7000
# Classic BPF's instructions, and what a filter of tc says of a packet.
LOAD_HALF, LOAD_BYTE, EQUAL, AT_LEAST, ABOVE, RETURN = 0x28, 0x30, 0x15, 0x35, 0x25, 0x06
DROP, PASS = 2, 0xFFFFFFFF
IN_OWN_NETWORK = ("unshare", "-rn", "sh", "-c", 'ip link set lo up && exec "$@"', "sh")


def own_network_possible() -> bool:
    """Return whether a network of its own can be made here, and packets dropped in it."""
    command = [*IN_OWN_NETWORK, "tc", "qdisc", "add", "dev", "lo", "clsact"]
    try:
        done = subprocess.run(command, capture_output=True, timeout=10.0, check=False)  # noqa: S603
    except OSError:
        return False
    return done.returncode == 0


def dds_ports(environment: Mapping[str, str]) -> tuple[int, int]:
    """Return the first and the last UDP port of the ROS domain (DDSI-RTPS 9.6.1.1)."""
    first = FIRST_PORT + PORTS_A_DOMAIN * int(environment.get("ROS_DOMAIN_ID", "0"))
    return first, first + PORTS_A_DOMAIN - 1


def drop_program(first: int, last: int) -> str:
    """Return classic BPF, as ``tc`` takes it, that drops UDP to DDS ports and passes the rest.

    To those from ``first`` to ``last``, and to those below 7400 that Fast DDS takes for its data.
    """
    program = (
        (LOAD_HALF, 0, 0, 12),  # what the frame carries,
        (EQUAL, 0, 8, 0x0800),  # IPv4,
        (LOAD_BYTE, 0, 0, 23),
        (EQUAL, 0, 6, 17),  # UDP,
        (LOAD_HALF, 0, 0, 36),  # to which port
        (AT_LEAST, 0, 4, FAST_DDS_PORT),
        (ABOVE, 0, 2, FIRST_PORT - 1),
        (AT_LEAST, 0, 2, first),
        (ABOVE, 1, 0, last),
        (RETURN, 0, 0, DROP),
        (RETURN, 0, 0, PASS),
    )
    words = [" ".join(str(part) for part in step) for step in program]
    return ",".join([str(len(program)), *words])


class DdsCut:
    """Drops what is sent to the DDS ports of the ROS domain; everything else gets through."""

    def __init__(self) -> None:
        """Make ready. Raises ``OSError`` where that is not possible."""
        if [name for _, name in socket.if_nameindex()] != ["lo"] or not shutil.which("tc"):
            raise OSError("fault dds: expected tc, and a network of its own as of `unshare -rn`")
        self._program = drop_program(*dds_ports(os.environ))
        self._tc("qdisc", "add", "dev", "lo", "clsact")

    def off(self) -> None:
        """Cut it."""
        self._tc("filter", "add", "dev", "lo", "egress", "bpf", "da", "bytecode", self._program)

    def on(self) -> None:
        """Let it through again."""
        self._tc("filter", "del", "dev", "lo", "egress")

    @staticmethod
    def _tc(*words: str) -> None:
        done = subprocess.run(  # noqa: S603
            ["tc", *words],  # noqa: S607
            capture_output=True,
            text=True,
            check=False,
            timeout=10.0,
        )
        if done.returncode != 0:
            raise OSError(f"tc {' '.join(words)}: {done.stderr.strip()}")
