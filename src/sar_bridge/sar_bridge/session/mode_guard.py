"""Who has the UAV: whether a mode may be chosen here, and when somebody else chose one. Pure."""

from __future__ import annotations


class ModeGuard:
    """Changes the mode only from GUIDED to AUTO after an engagement, and lets go of who is taken.

    ``released``: somebody took the UAV while the list was flown; nothing is sent until a new
    engagement. ``taken``: by what, told until another list is to be flown: the planner withdraws
    its list within milliseconds. ``returning``: an operator sent the UAV home.
    """

    def __init__(self) -> None:
        """Nobody has it yet."""
        self.released = False
        self.returning = False
        self.taken = ""
        self._engaging = False
        self._mode_flown = ""

    @property
    def takes_lists(self) -> bool:
        """Whether lists are taken at all."""
        return not (self.released or self.returning)

    def begin(self, mode: str, *, may_engage: bool) -> None:
        """Take a first list in a mode; ``may_engage``: whether it may change GUIDED to AUTO."""
        self._engaging, self._mode_flown = may_engage, mode

    def connect(self) -> None:
        """Begin with an autopilot whose mode is not known."""
        self._mode_flown = ""

    def withdraw(self) -> None:
        """Let go: the planner has withdrawn its list."""
        self.released = self.returning = self._engaging = False

    def send_home(self) -> None:
        """Let go: an operator sends the UAV home."""
        self._engaging, self.returning, self.taken = False, True, ""

    def may_start(self, mode: str) -> bool:
        """Whether AUTO may be chosen now that a list was taken; asked once for each."""
        engages, self._engaging = self._engaging and mode == "GUIDED", False
        return engages

    def is_taken(self, mode: str) -> bool:
        """Take the mode that is flown with a list; return whether somebody else chose it."""
        was, self._mode_flown = self._mode_flown, mode
        if mode == "AUTO" or (mode == "GUIDED" and was != "AUTO"):
            return False
        self.take(f"mode {mode} was chosen by somebody else")
        return True

    def take(self, by: str) -> None:
        """Let go: somebody took the UAV, ``by`` what."""
        self._engaging = False
        self.released, self.taken = True, by
