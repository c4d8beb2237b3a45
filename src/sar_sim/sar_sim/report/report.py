"""A flight's results folder: metrics, figures and a self-contained page, all from its bag."""

from __future__ import annotations

import base64
import html
import json
from pathlib import Path
from typing import Any

from sar_sim.report.figures import corner_to_draw, draw_corner, draw_lag, draw_map
from sar_sim.report.flight_data import read_flight
from sar_sim.report.metrics import coverage, flight_metrics

FIGURES = ("map.png", "corner.png", "lag.png")
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
    data = read_flight(bag)
    area = coverage(data)
    metrics = flight_metrics(data, area)
    out.mkdir(parents=True, exist_ok=True)
    (out / "metrics.json").write_text(json.dumps(metrics, indent=2) + "\n", encoding="utf-8")
    draw_map(data, area, out / "map.png")
    draw_corner(data, corner_to_draw(data), out / "corner.png")
    draw_lag(metrics, out / "lag.png")
    name = str(data.scenario.get("name", "flight"))
    (out / "report.html").write_text(_page(name, metrics, out), encoding="utf-8")
    return metrics


def _number(value: object, digits: int = 1) -> str:
    return f"{value:.{digits}f}" if isinstance(value, int | float) else "–"


def _page(name: str, metrics: dict[str, Any], out: Path) -> str:
    rows = [
        ("duration", _number(metrics["duration_s"], 0), "s"),
        ("corners", str(metrics["corners"]), ""),
        ("least separation", _number(metrics["min_separation_m"]), "m"),
        ("coverage", _number(metrics["coverage_percent"], 2), "%"),
        ("seen by both", _number(metrics["overlap_percent"], 2), "%"),
        ("claimed area", _number(metrics["claimed_km2"], 2), "km²"),
    ]
    summary = "".join(f"<tr><td>{a}</td><td>{b} {c}</td></tr>" for a, b, c in rows)
    watched = metrics["monitor"]
    lines = [
        (name.removesuffix("_m").replace("_", " "), f"{_number(value, 0)} m")
        for name, value in watched["thresholds"].items()
    ] + [(title, str(watched["counts"].get(name, "–"))) for name, title in MONITOR_COUNTS]
    monitor = "".join(f"<tr><td>{name}</td><td>{value}</td></tr>" for name, value in lines)
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
    images = "".join(
        f'<p><img alt="{figure}" src="data:image/png;base64,'
        f'{base64.b64encode((out / figure).read_bytes()).decode()}"></p>'
        for figure in FIGURES
    )
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(name)}</title>'
        f"<style>{STYLE}</style><h1>{html.escape(name)}</h1><table>{summary}</table>"
        f"<h2>Monitor</h2><table>{monitor}</table>"
        f"<h2>Corners</h2><table><tr><th>k</th>{header}</tr>{body}</table>{images}"
        "</html>\n"
    )
