"""When a step is due: at a multiple of real time, or by an autopilot's clock."""

import math

import pytest

from sar_sim.world.pacer import CATCH_UP, COAST_S, MAX_SLIP_S, AutopilotPacer, RealTimePacer


def test_real_time_waits_for_its_multiple():
    pacer = RealTimePacer(4.0, 100.0)
    assert pacer.wait_s(2.0, 100.0) == pytest.approx(0.5)
    assert pacer.wait_s(2.0, 100.5) == 0.0


def test_what_cannot_be_kept_up_with_is_let_go():
    pacer = RealTimePacer(1.0, 0.0)
    assert pacer.wait_s(1.0, 1.0 + 10.0 * MAX_SLIP_S) == 0.0
    assert pacer.wait_s(2.0, 1.0 + 10.0 * MAX_SLIP_S) == pytest.approx(1.0)


def test_a_hold_is_made_up_for_little_by_little():
    pacer = RealTimePacer(10.0, 0.0)
    assert pacer.wait_s(10.0, 1.0) == 0.0
    pacer.stood(1.0)
    # A hold of 1 s, of which 0.1 s pass in real time anyway.
    waits = [pacer.wait_s(time, 1.9) for time in (15.0, 20.0, 110.0)]
    sooner = 1.0 - CATCH_UP
    assert waits == pytest.approx([0.5 * sooner, 1.0 * sooner, 11.0 - 1.9])


def follow(pacer, speed, *, seconds, rate_hz=10.0, step_s=0.05, boot_s=50.0, late_s=0.0):
    """Step a simulation by what the autopilot tells; return its time and the real one."""
    time_s = told_s = real_s = 0.0
    while real_s < seconds:
        if real_s >= told_s:
            told_s += 1.0 / (rate_hz * speed)
            pacer.hear(boot_s + speed * (real_s - late_s), real_s)
        while pacer.wait_s(time_s, real_s) <= 0.0:
            time_s += step_s
        real_s += 0.001
    return time_s, real_s


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0, 10.0])
def test_the_autopilots_clock_is_kept_without_drift(speed):
    time_s, real_s = follow(AutopilotPacer(speed), speed, seconds=30.0)
    # It begins with the second message.
    assert time_s == pytest.approx(speed * real_s - 0.1, abs=0.06 + 0.01 * speed)


def test_it_stands_until_the_autopilot_is_heard_and_when_it_falls_silent():
    pacer = AutopilotPacer(1.0)
    assert pacer.wait_s(0.0, 0.0) == math.inf
    time_s, real_s = follow(pacer, 1.0, seconds=3.0)
    assert pacer.wait_s(time_s + COAST_S + 0.2, real_s + 60.0) == math.inf
    # What was due up to then is still flown.
    assert pacer.wait_s(time_s, real_s + 60.0) == 0.0


def test_it_begins_where_the_simulation_is_when_it_is_first_asked():
    pacer = AutopilotPacer(1.0)
    for i in range(40):
        pacer.hear(50.0 + 0.1 * i, 0.1 * i)
    assert pacer.wait_s(0.0, 3.9) == pytest.approx(0.0)
    assert pacer.wait_s(0.2, 3.9) == pytest.approx(0.2)


def test_a_reboot_goes_on_from_where_the_simulation_is():
    pacer = AutopilotPacer(1.0)
    time_s, real_s = follow(pacer, 1.0, seconds=5.0)
    pacer.hear(0.1, real_s)
    pacer.hear(1.1, real_s + 1.0)
    assert pacer.wait_s(time_s, real_s + 1.0) == pytest.approx(0.0)
    assert pacer.wait_s(time_s + 0.1, real_s + 1.0) == pytest.approx(0.1)


def test_a_speed_that_is_not_the_autopilots_is_named():
    with pytest.raises(ValueError, match=r"parameter speed = 10: expected 1, at which the auto"):
        follow(AutopilotPacer(10.0), 1.0, seconds=12.0)


def test_a_link_that_stood_and_delivers_all_at_once_is_no_other_speed():
    pacer = AutopilotPacer(1.0)
    for i in range(400):
        real_s = 0.1 * i
        # Between 20 and 23 s nothing is heard; then three seconds come at once.
        heard_s = 23.0 if 20.0 < real_s < 23.0 else real_s
        pacer.hear(0.1 * i, heard_s)
    assert pacer.speed == pytest.approx(1.0)
