"""The page's large figures. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sar_bridge.console.snapshot import STALE_S, Snapshot

NONE = "–"


@dataclass(frozen=True, slots=True)
class Figure:
    """``name``, and ``text`` as it is shown; grey where it is stale."""

    name: str
    text: str
    is_stale: bool
    is_wide: bool = False
    is_small: bool = False


def figures(snapshot: Snapshot) -> list[Figure]:
    """Return all figures, always the same names in the same order."""
    lost = max(snapshot.helicopter_age_s, snapshot.uav_age_s) > STALE_S
    no_uav = snapshot.uav_age_s > STALE_S
    no_planner, no_bridge = snapshot.is_stale("planner"), snapshot.is_stale("bridge")
    lags = "  ".join(f"L({k}) {lag:.0f}" for k, lag in snapshot.lags_m[-3:]) or NONE
    return [
        Figure("apart", _metres(snapshot.horizontal_m), lost),
        Figure("UAV higher by", _metres(snapshot.vertical_m), lost),
        Figure("lag L", _metres(snapshot.lag_m), no_planner),
        Figure("rule", snapshot.rule or NONE, no_planner),
        Figure("least apart, sure", _sure(snapshot), no_planner, is_small=True),
        Figure("lag at corners", lags, no_planner, is_wide=True, is_small=True),
        Figure("UAV mode", snapshot.status.mode or NONE, no_bridge, is_small=True),
        Figure("airspeed", _airspeed(snapshot), no_bridge, is_small=True),
        Figure("ground speed", _speed(snapshot), no_uav, is_small=True),
        Figure("wind", wind_text(snapshot.wind_mps), no_bridge, is_small=True),
        Figure("battery", _battery(snapshot), no_bridge, is_small=True),
        Figure("helicopter", _flies(snapshot), snapshot.is_stale("estimator"), is_small=True),
    ]


def _sure(snapshot: Snapshot) -> str:
    """Return what the list at a corner keeps whatever the corner is like, and for how long."""
    planner = snapshot.node("planner")
    kept, lasts = ("", "") if planner is None else map(planner.value, ("tube_m", "tube_s"))
    return f"{float(kept):.0f} m for {float(lasts):.0f} s" if kept and lasts else NONE


def _flies(snapshot: Snapshot) -> str:
    """Return what the helicopter does, and on which leg of its pattern."""
    planner = snapshot.node("planner")
    leg = "" if planner is None else planner.value("pattern_leg")
    return str(snapshot.phase or NONE) + (f", leg {leg}" if leg else "")


def _metres(value: float | None) -> str:
    return NONE if value is None or not math.isfinite(value) else f"{value:.0f} m"


def _airspeed(snapshot: Snapshot) -> str:
    """Return the UAV's airspeed, and how far its limits are."""
    bridge = snapshot.node("bridge")
    text = "" if bridge is None else bridge.value("airspeed_mps")
    if not text:
        return NONE
    airspeed = float(text)
    least = snapshot.parameters.get("AIRSPEED_MIN")
    most = snapshot.parameters.get("AIRSPEED_MAX")
    if least is None or most is None:
        return f"{airspeed:.1f} m/s"
    return f"{airspeed:.1f} m/s  -{airspeed - least:.0f} +{most - airspeed:.0f}"


def _speed(snapshot: Snapshot) -> str:
    return NONE if snapshot.uav is None else f"{snapshot.uav.motion.speed_mps:.1f} m/s"


def wind_text(wind_mps: tuple[float, float] | None) -> str:
    """Return the wind as aviation has it: where it comes from [deg], its speed [m/s]."""
    if wind_mps is None:
        return NONE
    east, north = wind_mps
    speed = math.hypot(east, north)
    if speed < 0.5:
        return "calm"
    return f"{math.degrees(math.atan2(-east, -north)) % 360.0:03.0f}° {speed:.0f} m/s"


def _battery(snapshot: Snapshot) -> str:
    bridge = snapshot.node("bridge")
    if bridge is None:
        return NONE
    volts, percent = bridge.value("battery_v"), bridge.value("battery_percent")
    parts = [f"{volts} V" if volts else "", f"{percent} %" if percent else ""]
    return " ".join(part for part in parts if part) or NONE
