"""What the fuzz tests of session and stations share."""

import pytest


def mangled(rng, data):
    """Return bytes with one to three of them turned, lost, or put in."""
    data = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(len(data)))
        kind = rng.integers(3)
        if kind == 0:
            data[at] = int(rng.integers(256))
        elif kind == 1 and len(data) > 1:
            del data[at]
        else:
            data.insert(at, int(rng.integers(256)))
    return bytes(data)


@pytest.fixture
def mangle():
    return mangled
