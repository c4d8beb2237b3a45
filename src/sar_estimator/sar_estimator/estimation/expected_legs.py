"""Where the legs of a search pattern are expected to end, which makes a corner there likelier.

A pilot who keeps to his pattern begins to slow about where that ends the leg; any other does it
anywhere. The mixture of both says how likely the onset is in the newest seconds, given that none
came before, over that of a pilot of whom nothing is expected. Where it is likelier less evidence
will do (the odds before times the Bayes factor are the odds after); nowhere is more asked for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sar_estimator.common.pose import wrap_angle

KEEPS = 0.8  # share of corners that are flown about where the pattern has them
SIGMA_SHARE, SIGMA_M = 0.03, 30.0  # by how much they are beside it: of the length, and more
NEWEST_S = 4.0  # in which an onset is looked for
NEW_LEG_RAD = math.radians(45.0)


def log_odds_gain(past_m: float, newest_m: float, length_m: float) -> float:
    """Return what is gained in log odds of an onset in the last ``newest_m`` [m] flown; 0 or more.

    ``past_m``: by how much the expected onset is passed [m]; ``length_m``: of the leg, over which
    an onset would be as likely anywhere.
    """
    sigma = SIGMA_SHARE * length_m + SIGMA_M
    later = _upper_tail(past_m / sigma)
    newest = _upper_tail((past_m - newest_m) / sigma) - later
    begun = KEEPS * newest * length_m / newest_m + 1.0 - KEEPS
    return max(0.0, math.log(begun / (KEEPS * later + 1.0 - KEEPS)))


def _upper_tail(z: float) -> float:
    """Return the probability that a standard normal is more than ``z``."""
    return 0.5 * math.erfc(z / math.sqrt(2.0))


class ExpectedLegs:
    """Counts the legs that are flown, and knows of each how long it is expected to be.

    A wrong count costs no detection: less evidence will do at a wrong place, that is all.
    """

    def __init__(self, lengths_m: Sequence[float]) -> None:
        """Expect legs of these lengths [m], from corner to corner; none for no expectation."""
        self._lengths_m = tuple(lengths_m)
        self._flown = 0
        self._from_m = (0.0, 0.0)
        self._heading_rad: float | None = None
        self._spent = False

    def begin(self, from_m: tuple[float, float], heading_rad: float) -> None:
        """Take a leg for the next if it has another heading; it began at a place [m]."""
        last_rad = self._heading_rad
        if last_rad is None or abs(wrap_angle(heading_rad - last_rad)) > NEW_LEG_RAD:
            self._heading_rad, self._from_m = heading_rad, from_m
            self._flown += 1
            self._spent = False

    def spend(self) -> None:
        """Expect nothing more of this leg: it went on where it was taken to end."""
        self._spent = True

    def gain(self, place_m: tuple[float, float], speed_mps: float, accel_mps2: float) -> float:
        """Return by how much less evidence will do at a place: a log Bayes factor, 0 or more.

        ``speed_mps``: of the leg; ``accel_mps2``: with which it is expected to be slowed.
        """
        if self._spent or not 0 < self._flown <= len(self._lengths_m):
            return 0.0
        length_m = self._lengths_m[self._flown - 1]
        onset_m = length_m - speed_mps**2 / (2.0 * accel_mps2)
        past_m = math.dist(place_m, self._from_m) - onset_m
        return log_odds_gain(past_m, NEWEST_S * speed_mps, length_m)
