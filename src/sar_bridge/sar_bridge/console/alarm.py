"""When the page sounds, and how. Pure; times [s] are of a monotonic clock."""

from __future__ import annotations

import math

from sar_bridge.console.banner import Banner, Urgency

Tone = tuple[int, float]
TONES: dict[Urgency, Tone] = {Urgency.CAUTION: (520, 0.25), Urgency.WARNING: (880, 0.35)}
"""Hertz and seconds."""
WARNING_AGAIN_S = 2.0


class Alarm:
    """A caution sounds once, a warning until it is acknowledged, or over."""

    def __init__(self) -> None:
        """Have sounded for nothing."""
        self._key, self._sounded_s = "", -math.inf

    def due(self, banner: Banner, now_s: float) -> Tone | None:
        """Return the tone that is due, None for none."""
        if not banner.sounds:
            self._key, self._sounded_s = "", -math.inf
            return None
        again = banner.urgency is Urgency.WARNING and now_s - self._sounded_s >= WARNING_AGAIN_S
        if banner.key == self._key and not again:
            return None
        self._key, self._sounded_s = banner.key, now_s
        return TONES[banner.urgency]
