"""A caution is heard once, a warning until somebody acknowledges it."""

import pytest

from sar_bridge.console.alarm import TONES, WARNING_AGAIN_S, Alarm
from sar_bridge.console.banner import Banner, Urgency

CAUTION = Banner(Urgency.CAUTION, "SEPARATION", "180 m in 20 s")
WARNING = Banner(Urgency.WARNING, "SEPARATION", "120 m in 9 s")
KNOWN = Banner(Urgency.WARNING, "SEPARATION", "120 m in 9 s", acknowledged=True)
NORMAL = Banner(Urgency.NORMAL, "IN FORMATION")


def test_a_caution_is_heard_once_and_again_when_it_comes_back():
    alarm = Alarm()
    assert alarm.due(CAUTION, 0.0) == TONES[Urgency.CAUTION]
    assert alarm.due(CAUTION, 60.0) is None
    assert alarm.due(NORMAL, 61.0) is None
    assert alarm.due(CAUTION, 62.0) == TONES[Urgency.CAUTION]


def test_a_warning_is_heard_until_it_is_acknowledged():
    alarm, heard = Alarm(), 0
    for n in range(21):
        heard += alarm.due(WARNING, 0.5 * n) is not None
    assert heard == 1 + int(10.0 / WARNING_AGAIN_S)
    assert alarm.due(KNOWN, 30.0) is None


@pytest.mark.parametrize("urgency", [Urgency.IDLE, Urgency.NORMAL])
def test_what_is_normal_is_silent(urgency):
    assert Alarm().due(Banner(urgency, "IN FORMATION"), 0.0) is None
