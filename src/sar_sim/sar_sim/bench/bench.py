"""What ``bench`` found: figures with what is asked of them, as a table and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Figure:
    """One figure; ``asked``: the most, or with ``at_least`` the least, that it should be."""

    part: str
    what: str
    value: float
    unit: str = ""
    asked: float | None = None
    at_least: bool = False

    @property
    def met(self) -> bool | None:
        """Whether it is as asked; None where nothing is."""
        if self.asked is None:
            return None
        return self.value >= self.asked if self.at_least else self.value <= self.asked

    def row(self) -> str:
        """Return it as a row of the table."""
        asked = ""
        if self.asked is not None:
            asked = f"{'≥' if self.at_least else '≤'} {self.asked:g}"
        word = {None: "", True: "met", False: "NOT MET"}[self.met]
        value = f"{self.value:.3g}" if abs(self.value) < 1000.0 else f"{self.value:.0f}"
        row = f"{self.part:10s} {self.what:58s} {value:>8s} {self.unit:6s} {asked:>8s} {word}"
        return row.rstrip()


def as_json(figures: Iterable[Figure]) -> str:
    """Return figures as a JSON document."""
    return json.dumps([{**asdict(one), "met": one.met} for one in figures], indent=2) + "\n"


def memory_kb(smaps_rollup: str) -> int:
    """Return a process' proportional set size [kB] from its ``smaps_rollup``; 0 where not told."""
    return _reported_kb(smaps_rollup, ("Pss:",))


def private_kb(smaps_rollup: str) -> int:
    """Return the memory [kB] that no other process shares, from a ``smaps_rollup``.

    Unlike the proportional set size it does not change when others begin or end.
    """
    return _reported_kb(smaps_rollup, ("Private_Clean:", "Private_Dirty:"))


def _reported_kb(smaps_rollup: str, names: tuple[str, ...]) -> int:
    lines = (line.split() for line in smaps_rollup.splitlines() if line.startswith(names))
    return sum(int(fields[1]) for fields in lines)


def cpu_ticks(stat: str) -> int:
    """Return user and system time [ticks] of a process from its ``stat`` (proc(5))."""
    fields = stat.rsplit(")", 1)[1].split()
    return int(fields[11]) + int(fields[12])


def node_name(cmdline: str) -> str | None:
    """Return which node a process is, from its ``cmdline`` (proc(5)); None for any other."""
    words = cmdline.split("\0")
    at = words.index("--ros-args") if "--ros-args" in words else 0
    return words[at - 1].rsplit("/", 1)[-1] if at else None


def pace(seen: list[tuple[float, float]]) -> float:
    """Return how many times faster than real time a flight went: of wall times and stamps [s].

    Raises ``ValueError`` where fewer than two were seen.
    """
    if len(seen) < 2:
        raise ValueError(f"{len(seen)} fixes seen: expected two or more")
    (first_s, first_stamp), (last_s, last_stamp) = seen[0], seen[-1]
    return (last_stamp - first_stamp) / (last_s - first_s)


def delays(
    fixes_s: list[float], lists_s: dict[int, float], accepted_s: dict[int, float], most_s: float
) -> list[tuple[float, float]]:
    """Return what it took from a fix to a list, and from there to the mission's acceptance [s].

    ``lists_s``, ``accepted_s``: when a list was seen, and accepted. Lists that came more
    than ``most_s`` after the last fix were not made for it.
    """
    found = []
    for list_id, accepted in sorted(accepted_s.items()):
        listed = lists_s.get(list_id)
        before = [fix for fix in fixes_s if listed is not None and fix <= listed]
        if listed is None or not before or listed - before[-1] > most_s:
            continue
        found.append((listed - before[-1], accepted - listed))
    return found
