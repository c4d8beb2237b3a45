"""What a flight was ordered to fly, as its bag tells it."""

import numpy as np
import pytest

from sar_estimator.common import topics
from sar_estimator.common.reports import MonitorReport
from sar_sim.report import figures
from sar_sim.report.flight_data import FlightData, Track
from sar_sim.scenario.scenario import Pattern, Scenario
from sar_sim.world.wires import ALL_WIRES

SQUARE = Pattern(2000.0, 900.0, corners=2, start_east_m=300.0, start_north_m=-100.0)


def flight(scenario, *, simulated=True):
    """Return a flight straight north, as if read from a bag of a scenario."""
    wire = ALL_WIRES[topics.SCENARIO]
    told = {} if scenario is None else wire.from_message(wire.to_message(scenario, 0.0))
    times = np.arange(0.0, 60.0)
    north = np.column_stack((np.zeros(60), 20.0 * times))
    tracks = [
        Track(times, north + np.array([across, 0.0]), np.zeros(60)) for across in (0.0, 250.0)
    ]
    return FlightData(*tracks, {}, [], [], told, MonitorReport(), simulated)


def test_the_pattern_that_was_ordered_begins_where_the_search_does():
    expected = [[300, -100], [300, 1900], [2300, 1900], [2300, 1000]]
    assert flight(Scenario(pattern=SQUARE)).ordered_m == pytest.approx(np.array(expected, float))


@pytest.mark.parametrize(
    "data",
    [
        flight(None),
        flight(Scenario(pattern=SQUARE), simulated=False),  # a recorded helicopter has its own
    ],
)
def test_behind_any_other_helicopter_none_was(data):
    assert data.ordered_m.shape == (0, 2)


@pytest.mark.parametrize(("simulated", "count"), [(True, 1), (False, 0)])
def test_it_is_a_dashed_line_under_the_tracks(monkeypatch, tmp_path, simulated, count):
    drawn = []
    monkeypatch.setattr(figures.Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    data = flight(Scenario(pattern=SQUARE), simulated=simulated)
    figures.draw_map([data], None, tmp_path / "map.png")
    (axes,) = drawn[0].axes
    tracks = [line for line in axes.lines if line.get_label() == "helicopter"]
    lines = [line for line in axes.lines if line.get_label() == "pattern ordered"]
    assert len(lines) == count
    for line in lines:
        assert line.get_linestyle() == "--"
        assert line.get_zorder() < tracks[0].get_zorder()
        assert line.get_xydata() == pytest.approx(data.ordered_m)
