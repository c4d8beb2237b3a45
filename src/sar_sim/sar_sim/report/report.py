"""A flight's results folder: metrics, figures and a self-contained page, all from its bag."""

from __future__ import annotations

import base64
import html
import json
from pathlib import Path
from typing import Any

from sar_sim.report.figures import corner_to_draw, draw_corner, draw_lag, draw_map
from sar_sim.report.flight_data import read_flights
from sar_sim.report.metrics import coverage, flight_metrics, formation_metrics

MONITOR_COUNTS = (
    ("caution", "cautions"),
    ("warning", "warnings"),
    ("escape", "escapes"),
    ("passed", "lists passed"),
    ("refused", "lists refused"),
)
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; color: #222;
       padding: 0 1rem; }
table { border-collapse: collapse; } td, th { padding: .25rem .8rem; text-align: right;
       border-bottom: 1px solid #ddd; } th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; }
"""


def write_report(bag: Path, out: Path) -> dict[str, Any]:
    """Rebuild every result from ``bag`` into ``out``; return the metrics.

    Raises ``ValueError`` when the bag has no flight in it.
    """
    flights = read_flights(bag)
    area = coverage(flights)
    metrics = formation_metrics(flights, area)
    out.mkdir(parents=True, exist_ok=True)
    (out / "metrics.json").write_text(json.dumps(metrics, indent=2) + "\n", encoding="utf-8")
    draw_map(flights, area, out / "map.png")
    for data in flights:
        draw_corner(data, corner_to_draw(data), out / of_uav("corner.png", data.name))
        draw_lag(flight_metrics(data, area), out / of_uav("lag.png", data.name))
    name = str(flights[0].scenario.get("name", "flight"))
    (out / "report.html").write_text(_page(name, metrics, out), encoding="utf-8")
    return metrics


def of_uav(figure: str, name: str) -> str:
    """Return the file of a UAV's figure: with its name, where it has one."""
    stem, dot, suffix = figure.partition(".")
    return f"{stem}_{name}{dot}{suffix}" if name else figure


def _number(value: object, digits: int = 1) -> str:
    return f"{value:.{digits}f}" if isinstance(value, int | float) else "–"


def _page(name: str, metrics: dict[str, Any], out: Path) -> str:
    rows = [
        ("duration", _number(metrics["duration_s"], 0), "s"),
        ("corners", str(metrics["corners"]), ""),
        ("coverage", _number(metrics["coverage_percent"], 2), "%"),
        ("seen by two or more", _number(metrics["overlap_percent"], 2), "%"),
        ("claimed area", _number(metrics["claimed_km2"], 2), "km²"),
    ]
    if metrics["uavs_apart_m"] is not None:
        rows.append(("UAVs apart, least", _number(metrics["uavs_apart_m"]), "m"))
    summary = "".join(f"<tr><td>{a}</td><td>{b} {c}</td></tr>" for a, b, c in rows)
    uavs = metrics["uavs"] or {"": metrics}
    body = "".join(_uav(uav, one, out) for uav, one in uavs.items())
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(name)}</title>'
        f"<style>{STYLE}</style><h1>{html.escape(name)}</h1><table>{summary}</table>"
        f"{_image('map.png', out)}{body}</html>\n"
    )


def _image(figure: str, out: Path) -> str:
    data = base64.b64encode((out / figure).read_bytes()).decode()
    return f'<p><img alt="{figure}" src="data:image/png;base64,{data}"></p>'


def _uav(name: str, metrics: dict[str, Any], out: Path) -> str:
    """Return what is told of one UAV."""
    watched = metrics["monitor"]
    lines = [
        ("least separation", f"{_number(metrics['min_separation_m'])} m"),
        *(
            (threshold.removesuffix("_m").replace("_", " "), f"{_number(value, 0)} m")
            for threshold, value in watched["thresholds"].items()
        ),
        *((title, str(watched["counts"].get(kind, "–"))) for kind, title in MONITOR_COUNTS),
    ]
    monitor = "".join(f"<tr><td>{title}</td><td>{value}</td></tr>" for title, value in lines)
    columns = (
        ("L(k), m", "lag_m", 1),
        ("measured L(k), m", "lag_measured_m", 1),
        ("rule", "rules", 0),
        ("predicted L(k+1), m", "next_lag_predicted_m", 1),
        ("extra path, m", "extra_path_m", 1),
        ("detected after, s", "detection_delay_s", 1),
        ("corner error, m", "corner_error_m", 1),
    )
    count = max((len(metrics[key]) for _, key, _ in columns), default=0)
    body = ""
    for k in range(count):
        cells = []
        for _, key, digits in columns:
            value = metrics[key][k] if k < len(metrics[key]) else None
            text = value if isinstance(value, str) else _number(value, digits)
            cells.append(f"<td>{html.escape(text)}</td>")
        body += f"<tr><td>{k + 1}</td>{''.join(cells)}</tr>"
    header = "".join(f"<th>{title}</th>" for title, _, _ in columns)
    images = "".join(_image(of_uav(figure, name), out) for figure in ("corner.png", "lag.png"))
    of = f" of {html.escape(name)}" if name else ""
    return (
        f"<h2>Separation{of}</h2><table>{monitor}</table>"
        f"<h2>Corners{of}</h2><table><tr><th>k</th>{header}</tr>{body}</table>{images}"
    )
