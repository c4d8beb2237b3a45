"""The figures of a flight (matplotlib): fig. 9, fig. 10 and L(k)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.ticker import MaxNLocator
from shapely.geometry.base import BaseGeometry

from sar_estimator.common.checked import read
from sar_sim.report.coverage import Coverage, FloatArray, swath
from sar_sim.report.flight_data import FlightData
from sar_sim.scenario.scenario import Sensor

HELICOPTER, UAV, PLAN, GAP = "#c1440e", "#0b5394", "#2a9d8f", "#d62828"
ORDERED = "#777777"
UAVS = (UAV, "#6a3d9a", "#b8860b", "#00796b")
CUT_CORNERS = ("T1", "D1")
RULE_MARKERS = {
    "T1": "s",
    "T2": "D",
    "T3": "o",
    "T4": "^",
    "D1": "s",
    "D2": "o",
    "D3": "^",
    "D4": "D",
    "O1": "p",
    "O2": "h",
    "O3": "v",
    "RJ": "x",
}


def _fill(axes: Axes, shape: BaseGeometry, colour: str, alpha: float, label: str = "") -> None:
    """Draw a polygon or multipolygon with its holes."""
    parts = getattr(shape, "geoms", [shape])
    vertices: list[Any] = []
    codes: list[Any] = []
    for part in parts:
        if part.geom_type != "Polygon":
            continue
        for ring in (part.exterior, *part.interiors):
            points = np.asarray(ring.coords)
            vertices.append(points)
            codes += [Outline.MOVETO, *[Outline.LINETO] * (len(points) - 2), Outline.CLOSEPOLY]
    if vertices:
        outline = Outline(np.concatenate(vertices), codes)
        axes.add_patch(
            PathPatch(outline, facecolor=colour, alpha=alpha, edgecolor="none", label=label)
        )


def _axes(figure: Figure, title: str) -> Axes:
    axes = figure.add_subplot()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title(title)
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.grid(visible=True, alpha=0.3)
    return axes


def draw_map(flights: Sequence[FlightData], area: Coverage | None, out: Path) -> None:
    """Draw all tracks, corners, swaths, gaps and the pattern ordered (the paper's fig. 9).

    ``flights``: of every UAV behind one helicopter.
    """
    data = flights[0]
    figure = Figure(figsize=(9, 9), layout="constrained")
    title = "Aircraft paths" if area is None else f"Aircraft paths, coverage {area.percent:.2f} %"
    axes = _axes(figure, title)
    if len(data.ordered_m):
        axes.plot(*data.ordered_m.T, "--", color=ORDERED, lw=0.9, zorder=1, label="pattern ordered")
    radius = read(Sensor, data.scenario.get("sensor", {}), "sensor", texts=True)
    uavs = [(one.uav, UAVS[i % len(UAVS)], one.name or "UAV") for i, one in enumerate(flights)]
    for track, colour, name in ((data.helicopter, HELICOPTER, "helicopter"), *uavs):
        if len(track) > 1:
            seen = swath(track.xy_m, radius.radius_m, footprint=radius.footprint)
            _fill(axes, seen, colour, 0.10, f"{name}'s swath")
            axes.plot(*track.xy_m.T, color=colour, lw=1.4, label=name)
            axes.plot(*track.xy_m[0], ">", color=colour, ms=7)
    if area is not None:
        _fill(axes, area.gaps, GAP, 0.8, "not seen")
    for k, item in sorted(data.planned.items()):
        x, y = item.last.stop[:2]
        axes.annotate(f"{k} {item.last.rule}", (x, y), textcoords="offset points", xytext=(6, 6))
        axes.plot(x, y, "k+", ms=8)
    axes.legend(loc="best", fontsize=8)
    figure.savefig(out, dpi=110)


def corner_to_draw(data: FlightData) -> int | None:
    """Return the corner that is drawn close up: the first that cuts, else the first."""
    cuts = [k for k, item in sorted(data.planned.items()) if item.last.rule in CUT_CORNERS]
    return next(iter(cuts or sorted(data.planned)), None)


def draw_corner(data: FlightData, k: int | None, out: Path) -> None:
    """Draw one corner: planned and flown path, waypoints, corner estimates (fig. 10)."""
    figure = Figure(figsize=(9, 7.5), layout="constrained")
    axes = _axes(figure, "No corner was planned" if k is None else "")
    if k is not None:
        item = data.planned[k]
        record, first = item.last, item.first
        axes.set_title(
            f"Corner {k}: {record.rule}, L = {record.lag_m:.0f} m, "
            f"predicted L(k+1) = {record.next_lag_m:.0f} m"
        )
        onset = record.onset_time_s
        last = onset + record.length_m / record.speed_mps + 15.0
        for track, colour, name in (
            (data.helicopter, HELICOPTER, "helicopter, flown"),
            (data.uav, UAV, "UAV, flown"),
        ):
            part = track.between(onset - 15.0, last)
            axes.plot(*part.xy_m.T, color=colour, lw=1.8, label=name)
        # A bag that was cut between a decision and its curve has the one alone.
        path = item.curve if len(item.curve) else np.array([record.stop[:2]])
        axes.plot(*path.T, "--", color=PLAN, lw=1.5, label="UAV, planned")
        low, high = path.min(axis=0) - 150.0, path.max(axis=0) + 150.0
        near = item.waypoints[np.all((item.waypoints > low) & (item.waypoints < high), axis=1)]
        if len(near):
            axes.plot(*near.T, "x", color="k", ms=6, label="commanded waypoints")
        axes.plot(*first.stop[:2], "o", mfc="none", mec="k", ms=14, label="first corner estimate")
        axes.plot(*record.stop[:2], "k+", ms=12, mew=2, label="final corner estimate")
        axes.legend(loc="best", fontsize=9)
    figure.savefig(out, dpi=110)


def draw_lag(metrics: dict[str, Any], out: Path) -> None:
    """Draw L(k) and the prediction for it, marked with the active rule."""
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.add_subplot()
    lags, rules = metrics["lag_m"], metrics["rules"]
    axes.axhline(0.0, color="k", lw=0.8)
    axes.plot(range(1, len(lags) + 1), lags, color=UAV, lw=1.2, label="L(k)")
    for rule, marker in RULE_MARKERS.items():
        chosen = [(k + 1, lag) for k, lag in enumerate(lags) if k < len(rules) and rules[k] == rule]
        if chosen:
            axes.plot(*np.array(chosen).T, marker, color=UAV, ms=8, label=rule)
    predicted = metrics["next_lag_predicted_m"]
    if predicted:
        axes.plot(
            range(2, len(predicted) + 2),
            predicted,
            "_",
            color=PLAN,
            ms=16,
            mew=2,
            label="predicted for the next corner",
        )
    axes.set_xlabel("corner k")
    axes.set_ylabel("lag L, m")
    axes.set_title("UAV's lag when the helicopter begins to slow")
    axes.grid(visible=True, alpha=0.3)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="best", fontsize=9)
    figure.savefig(out, dpi=110)


def draw_lags(missions: list[tuple[float, ...]], title: str, path: Path) -> None:
    """Draw L(k) of many missions against the corner."""
    figure = Figure(figsize=(8.0, 4.5), layout="constrained")
    axes = figure.subplots()
    for lags in missions:
        axes.plot(range(1, len(lags) + 1), lags, color=UAV, alpha=0.35, marker=".", linewidth=0.9)
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="corner k", ylabel="L(k) [m]", title=f"{title}: {len(missions)} missions")
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def draw_lag_grid(panels: list[list[tuple[str, list[tuple[float, ...]]]]], path: Path) -> None:
    """Draw L(k) of many missions, a panel for each title: rows of panels share no scale."""
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    axes = figure.subplots(len(panels), len(panels[0]), sharex=True, squeeze=False)
    for row, panel_row in zip(axes, panels, strict=True):
        for panel, (title, missions) in zip(row, panel_row, strict=True):
            for lags in missions:
                panel.plot(
                    range(1, len(lags) + 1), lags, color=UAV, alpha=0.4, marker=".", linewidth=0.9
                )
            panel.axhline(0.0, color="black", linewidth=0.8)
            panel.set_title(title, fontsize=10)
            panel.grid(alpha=0.3)
        row[0].set_ylabel("L(k) [m]")
    for panel in axes[-1]:
        panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        panel.set_xlabel("corner k")
    figure.savefig(path, dpi=90)


def draw_rules(series: dict[str, dict[str, FloatArray]], separation_m: float, path: Path) -> None:
    """Draw L(k+1) and the closest approach against L(k) for several rule sets, side by side.

    ``series``: by rule set, arrays ``lag``, ``next``, ``closest``, each of shape (n,) [m].
    """
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    axes = figure.subplots(2, len(series), sharex=True, sharey="row", squeeze=False)
    for column, (name, values) in enumerate(series.items()):
        upper, lower = axes[0][column], axes[1][column]
        upper.plot(values["lag"], values["next"], color=UAV, linewidth=1.6)
        upper.axhline(0.0, color="black", linewidth=0.8)
        upper.set_title(f"rules {name}")
        lower.plot(values["lag"], values["closest"], color=HELICOPTER, linewidth=1.6)
        lower.axhline(separation_m, color="black", linewidth=0.8, linestyle="--")
        lower.set(xlabel="L(k) [m]")
        for panel in (upper, lower):
            panel.grid(alpha=0.3)
    axes[0][0].set_ylabel("L(k+1) [m]")
    axes[1][0].set_ylabel("closest approach [m]")
    axes[1][0].set_ylim(0.0, None)
    figure.savefig(path, dpi=110)
