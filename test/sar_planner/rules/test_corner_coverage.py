"""What a corner's path leaves uncovered, against areas by shapely."""

import math

import numpy as np
import pytest

from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.slot_intercept import STRAIGHT_Q, STRAIGHT_Y, PathBatch, row_of
from sar_planner.rules.corner_coverage import SweepAt, sweep_of
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.paper_rules import Rule
from sar_sim.report.coverage import IdealSlot, ideal_tracks, swath

P = CornerParameters()


def test_a_weave_sees_what_a_late_curve_leaves_out():
    """A curve that joins the new slot track far down it leaves the swath before uncovered."""
    rules = DeadbeatRules(CornerParameters())
    problem = rules.paths.problem(0.0)
    curves = rules.paths.exact(problem, 110.0, (STRAIGHT_Y, STRAIGHT_Q))
    late = curves.take(np.flatnonzero(curves.ends[:, 0] > 1000.0))
    assert len(late) > 0
    weave = rules.plan(0.0, lead_m=110.0, separation_m=200.0)
    assert weave.rule is Rule.D4
    headings = np.radians([[160.0, 23.0, 46.0]])
    woven = rules.paths.weaves(problem, 110.0, headings)
    assert rules.paths.uncovered_m2(woven).min() < 0.3 * rules.paths.uncovered_m2(late).min()


@pytest.mark.parametrize(
    ("lead", "separation", "most_m2", "turn_deg"),
    [(110, 200, 9e3, 90), (110, 230, 27e3, 90), (90, 230, 9e3, 90), (40, 200, 3e4, 120)],
)
def test_what_a_corner_leaves_unseen(lead, separation, most_m2, turn_deg):
    """Against an area by shapely, of both aircraft and the ideal swaths."""
    turn = math.radians(turn_deg)
    rules = DeadbeatRules(P, turn_rad=turn)
    plan = rules.plan(0.0, lead_m=float(lead), separation_m=float(separation))
    reach = 2500.0
    way = np.array((math.cos(turn), -math.sin(turn)))
    helicopter = np.array([(-reach, 0.0), (0.0, 0.0), reach * way])
    _, strip = ideal_tracks(helicopter, [IdealSlot([250.0] * 2)])
    path = plan.path.sample(5.0)
    flown = np.vstack(((-reach, -250.0), path, path[-1] + reach * way))
    seen = swath(flown, 125.0).union(swath(helicopter, 125.0))
    uncovered = swath(strip, 125.0).difference(seen).area
    assert 0.0 < uncovered < most_m2
    row = row_of(rules.paths.frame.path_from_map(plan.path))
    batch = PathBatch(rules.paths.problem(0.0).start, P.turn_radius_m, row[None, :])
    assert rules.paths.uncovered_m2(batch)[0] == pytest.approx(uncovered, rel=0.15, abs=1500.0)


def test_a_corner_elsewhere_is_the_same_corner():
    """In a frame whose track passes the corner farther on, as when a path is corrected."""
    rules = DeadbeatRules(P)
    path = rules.paths.frame.path_from_map(rules.plan(0.0, separation_m=200.0).path)
    row = row_of(path)[None, :]
    here = PathBatch(path.start, P.turn_radius_m, row)
    there = PathBatch(path.start._replace(x_m=path.start.x_m + 700.0), P.turn_radius_m, row)
    assert SweepAt(P.spacing_m, 700.0).uncovered_m2(there) == pytest.approx(
        sweep_of(P.spacing_m).uncovered_m2(here)
    )
