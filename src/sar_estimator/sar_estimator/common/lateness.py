"""How late a node is: how old fixes are when it uses them, and lists when they are flown. Pure.

Lateness is measured as a maximum that decays by half every ``HALF_S``. It is a bound to plan with:
a single late list counts at once, where a quantile would wait for as many of them as it leaves out,
and it asks for no more samples than there are: five decisions a second, but on a leg a list in half
a minute. One late list alone is a quarter of itself after 40 s, an eighth after a minute.
"""

from __future__ import annotations

import math

from sar_estimator.common.reports import Uploaded

HALF_S = 20.0
LONGEST_S = 10.0
"""A list that took longer counts as much; a fix that did is lost, as the estimator says."""
SLACK_S = 0.5
"""By so much a list may be later than assumed: 10 m of flight, by which it is joined as well."""
MOST_LISTS = 50
LATE = "laptop is late"
"""How what is told of it begins."""


def counted_s(late_s: float, assumed_s: float, most_s: float) -> float:
    """Return the delay [s] to count on where ``late_s`` is measured and ``assumed_s`` is assumed.

    The measured one where it is clearly more, but no more than ``most_s`` of it.
    """
    return max(assumed_s, min(late_s, most_s)) if late_s > assumed_s + SLACK_S else assumed_s


class Lateness:
    """A decaying maximum of delays [s]."""

    def __init__(self) -> None:
        """Have measured nothing."""
        self._late_s = 0.0
        self._at_s = -math.inf

    def add(self, late_s: float, now_s: float) -> None:
        """Take a delay [s]; one that is no number does not count, one below zero is none."""
        if math.isfinite(late_s + now_s):
            self._late_s = max(self.value_s(now_s), min(max(late_s, 0.0), LONGEST_S))
            self._at_s = now_s

    def value_s(self, now_s: float) -> float:
        """Return how late it was of late [s], 0 where nothing was measured.

        Where the clock was set back it is as it was.
        """
        if self._late_s == 0.0:
            return 0.0
        since_s = max(now_s - self._at_s, 0.0)
        return 0.0 if math.isinf(since_s) else self._late_s * 0.5 ** (since_s / HALF_S)


class Punctuality:
    """The two delays of a node that plans or watches, times [s] of one clock.

    ``fixes``: from a fix of the helicopter to the first use of it, which is not how often the
    receiver gives them. ``lists``: from a list to when the autopilot was told to have it; lists
    that never came there, because a newer one did, do not count.
    """

    def __init__(self) -> None:
        """Have measured nothing."""
        self.fixes, self.lists = Lateness(), Lateness()
        self._fix_s: float | None = None
        self._given: dict[int, float] = {}

    def hear_fix(self, fix_s: float) -> None:
        """Take when the newest fix was, that all that is told of the helicopter rests on."""
        self._fix_s = fix_s

    def use(self, now_s: float) -> None:
        """Take note that what is known is used now: the first time since a fix, that is late.

        Not by more than ``LONGEST_S``: the clock was set, or the receiver's.
        """
        if self._fix_s is not None and now_s - self._fix_s <= LONGEST_S:
            self.fixes.add(now_s - self._fix_s, now_s)
        self._fix_s = None

    def give(self, list_id: int, now_s: float) -> None:
        """Take note that a list is given away, to be flown."""
        self._given[list_id] = now_s
        while len(self._given) > MOST_LISTS:
            del self._given[min(self._given)]

    def flown(self, list_id: int, now_s: float) -> None:
        """Take note that the autopilot has a list; one that was not given away does not count."""
        given_s = self._given.get(list_id)
        if given_s is not None:
            self.lists.add(now_s - given_s, now_s)
            self._given = {one: at for one, at in self._given.items() if one > list_id}

    def hear_uploaded(self, uploaded: Uploaded, now_s: float) -> None:
        """Take that the autopilot has accepted a list."""
        self.flown(uploaded.list_id, now_s)

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet; the delays stay as they were."""
        self._fix_s = None
        self._given.clear()

    def problem(self, now_s: float, most_s: float) -> str:
        """Return that fixes are older than ``most_s`` when they are used, empty where not."""
        late_s = self.fixes.value_s(now_s)
        return f"{LATE}: fixes {late_s:.1f} s old at decision" if late_s > most_s else ""

    def values(self, now_s: float) -> dict[str, str]:
        """Return both as they are told in ``/diagnostics`` [s]."""
        return {
            "fix_late_s": f"{self.fixes.value_s(now_s):.1f}",
            "list_late_s": f"{self.lists.value_s(now_s):.1f}",
        }
