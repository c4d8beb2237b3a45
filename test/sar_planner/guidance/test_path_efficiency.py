"""What is learnt of the share of its speed that an autopilot makes good at corners."""

import pytest

from sar_planner.guidance.path_efficiency import PathEfficiency


def fly_corner(efficiency, share, *, seconds=60):
    efficiency = efficiency.begun(20.0)
    for second in range(seconds):
        efficiency = efficiency.watched(float(second), 20.0 * share * second, 20.0)
    return efficiency


def test_share_is_learnt_from_corner_to_corner_and_in_the_corner():
    one = fly_corner(PathEfficiency(0.5), 0.7)
    assert 0.7 < one.now < 0.76
    one = one.learnt()
    assert one.share == pytest.approx(0.85)
    for _ in range(6):
        one = fly_corner(one, 0.7).learnt()
    assert one.share == pytest.approx(0.7, abs=0.01)
    assert one.now == one.share


def test_bounds_short_corners_and_corners_given_up():
    assert fly_corner(PathEfficiency(1.0), 0.1).learnt().share == 0.5
    assert fly_corner(PathEfficiency(1.0), 0.6, seconds=3).learnt().share == 1.0
    assert fly_corner(PathEfficiency(1.0), 0.6).cancelled().learnt().share == 1.0


def test_another_path_begins_its_own_count():
    one = PathEfficiency(1.0).begun(20.0)
    for second in range(30):
        one = one.watched(float(second), 20.0 * second, 20.0)
    one = one.moved()
    for second in range(30, 60):
        one = one.watched(float(second), 20.0 * (second - 30), 20.0)
    assert one.learnt().share == pytest.approx(1.0)


def test_what_was_flown_before_is_forgotten_and_the_rest_of_the_corner_learnt():
    one = fly_corner(PathEfficiency(1.0), 0.5).restarted()
    for second in range(60):
        one = one.watched(float(second), 16.0 * second, 20.0)
    assert one.learnt().share == pytest.approx(0.8)
    assert fly_corner(PathEfficiency(1.0), 0.5).restarted().learnt().share == 1.0


def test_what_is_not_watched_changes_nothing():
    one = PathEfficiency(0.5, 0.9)
    assert one.watched(1.0, 20.0, 20.0) is one
    assert one.moved() is one
    assert one.restarted() is one
    assert one.learnt() == one


def test_of_an_autopilot_that_tells_nothing_the_first_corner_says_all():
    known, unknown = (
        PathEfficiency(0.5).begun(20.0),
        PathEfficiency(0.5).begun(20.0, is_known=False),
    )
    for second in range(7):
        known, unknown = (
            one.watched(float(second), 12.0 * second, 20.0) for one in (known, unknown)
        )
    assert unknown.now < 0.72
    assert known.now > 0.8
    for second in range(7, 30):
        unknown = unknown.watched(float(second), 12.0 * second, 20.0)
    first = unknown.learnt()
    assert first.share == pytest.approx(0.6)
    again = first.begun(20.0, is_known=False)
    assert again.corner == first.begun(20.0).corner


def test_a_few_seconds_of_a_corner_teach_nothing_either_way():
    for is_known in (True, False):
        one = PathEfficiency(0.5).begun(20.0, is_known=is_known)
        for second in range(6):
            one = one.watched(float(second), 12.0 * second, 20.0)
        assert one.learnt() == PathEfficiency(0.5)
