"""Values from component to component, in order, each as a message would carry it."""

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Component, Notice
from sar_estimator.common.reports import UavReport
from sar_estimator.common.states import Motion, Phase
from sar_sim.flight.bus import Bus, Joined


class Echo(Component):
    """Answers a speed with a lag, and remembers what it was told."""

    def __init__(self, listens, answers=()):
        super().__init__()
        self.heard = []
        self._answers = answers
        self.inputs = dict.fromkeys(listens, self._take)

    def start(self, now_s):
        return [(topics.MODE, "idle")]

    def tick(self, now_s):
        return [(topics.SPEED, now_s)]

    def _take(self, value, now_s):
        self.heard.append((value, now_s))
        return [(topic, value) for topic in self._answers]


def test_what_is_published_is_handed_on_at_once_and_what_comes_of_it_too():
    order = []
    first = Echo([topics.SPEED], [topics.LAG, NOTICES])
    second = Echo([topics.SPEED, topics.LAG])
    bus = Bus(
        (Joined(first), Joined(second)),
        record=lambda topic, value: order.append((topic, value)),
        listeners={topics.LAG: lambda value: order.append(("heard", value))},
    )
    bus.now_s = 3.0
    bus.start((Joined(first),))
    bus.tick(first)
    assert order == [
        (topics.MODE, "idle"),
        (topics.SPEED, 3.0),
        (topics.LAG, 3.0),
        ("heard", 3.0),
    ]
    assert second.heard == [(3.0, 3.0), (3.0, 3.0)]


def test_notices_go_nowhere():
    recorded = []
    bus = Bus((), record=lambda topic, _: recorded.append(topic))
    bus.publish(NOTICES, Notice("info", "said"))
    assert recorded == []


def test_values_are_handed_on_as_messages_carry_them():
    """Odometry has no acceleration."""
    component = Echo([topics.UAV_ODOMETRY])
    bus = Bus((Joined(component),))
    bus.publish(topics.UAV_ODOMETRY, UavReport(Motion(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0), 0.1))
    ((report, _),) = component.heard
    assert (report.motion.ax_mps2, report.motion.ay_mps2) == (0.0, 0.0)


def test_what_is_of_a_uav_stays_with_it_and_what_is_the_helicopters_is_for_all():
    one, two = Echo([topics.SPEED, topics.PHASE]), Echo([topics.SPEED, topics.PHASE])
    listener = Echo(["/uav1/uav/speed"])
    recorded = []
    bus = Bus(
        (Joined(one, "uav1"), Joined(two, "uav2"), Joined(listener, "uav2")),
        record=lambda topic, _: recorded.append(topic),
    )
    bus.publish(topics.SPEED, 21.0, "uav1")
    bus.publish(topics.PHASE, Phase.CRUISE)
    assert [value for value, _ in one.heard] == [21.0, Phase.CRUISE]
    assert [value for value, _ in two.heard] == [Phase.CRUISE]
    assert [value for value, _ in listener.heard] == [21.0]
    assert recorded == ["/uav1/uav/speed", topics.PHASE]
