"""Node ``estimator``: the helicopter's GPS in; odometry, phase and corner out."""

from __future__ import annotations

import math
import sys

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import AccelWithCovarianceStamped, PoseWithCovarianceStamped, TwistStamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import String

from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    datum_message,
    diagnostics,
    fix_outputs,
    from_stamp,
    message_to_fix,
    prediction_outputs,
    text_message,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.node_support import (
    LATCHED,
    RELIABLE,
    now_s,
    parameter,
    parameters,
    report_each_second,
    run_node,
)
from sar_estimator.common.states import Phase
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.fix_screen import Verdict
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters


class EstimatorNode(Node):
    """Feeds the estimator and publishes what it knows."""

    def __init__(self) -> None:
        """Declare parameters, topics and timers."""
        super().__init__("estimator")
        settings = parameters(self, EstimatorParameters)
        latitude = parameter(self, "datum_latitude_deg", math.nan)
        longitude = parameter(self, "datum_longitude_deg", math.nan)
        altitude = parameter(self, "datum_altitude_m", 0.0)
        self._velocity_sigma = parameter(self, "velocity_sigma_mps", VELOCITY_SIGMA_MPS)
        rate = parameter(self, "prediction_rate_hz", 5.0)
        if not 0.0 < rate <= 100.0:
            raise ValueError(f"parameter prediction_rate_hz = {rate}: expected 0 to 100")
        given = not (math.isnan(latitude) and math.isnan(longitude))
        datum = Datum(latitude, longitude, altitude) if given else None
        self._estimator = HelicopterEstimator(settings, datum)
        self._phase: Phase | None = None
        self._datum_sent = False
        self._newest_s = -math.inf
        self._senders = {
            topic: self.create_publisher(kind, topic, RELIABLE)
            for topic, kind in (
                (topics.HELICOPTER_ODOMETRY, Odometry),
                (topics.HELICOPTER_ACCEL, AccelWithCovarianceStamped),
                (topics.LEG, Odometry),
                (topics.CORNER, PoseWithCovarianceStamped),
                (topics.PREDICTION, Path),
                (topics.DIAGNOSTICS, DiagnosticArray),
            )
        }
        self._phase_sender = self.create_publisher(String, topics.PHASE, LATCHED)
        self._datum_sender = self.create_publisher(NavSatFix, topics.DATUM, LATCHED)
        self.create_subscription(NavSatFix, topics.FIX, self._on_fix, qos_profile_sensor_data)
        self.create_subscription(
            TwistStamped, topics.VELOCITY, self._on_velocity, qos_profile_sensor_data
        )
        self.create_timer(1.0 / rate, self._on_timer)
        report_each_second(self, self._on_diagnostics)
        self._send_datum()

    def _on_fix(self, message: NavSatFix) -> None:
        verdict = self._estimator.add_fix(message_to_fix(message))
        if not verdict.moved:
            return
        self._send_datum()
        self._publish(from_stamp(message.header.stamp))

    def _publish(self, stamp: float) -> None:
        """Publish what a fix, or its velocity, has changed."""
        self._send_phase(stamp)
        for topic, output in fix_outputs(self._estimator, stamp):
            self._senders[topic].publish(output)

    def _on_velocity(self, message: TwistStamped) -> None:
        velocity, stamp = message.twist.linear, from_stamp(message.header.stamp)
        before = self._estimator.corner
        self._estimator.add_velocity(stamp, velocity.x, velocity.y, self._velocity_sigma)
        if self._estimator.corner is not before:  # it came after its fix, and says more
            self._publish(stamp)

    def _on_timer(self) -> None:
        now = now_s(self)
        if now < self._newest_s - 1.0:
            self.get_logger().warning(f"clock set back by {self._newest_s - now:.1f} s: restarting")
            self._estimator.restart_clock()
        self._newest_s = now
        for topic, output in prediction_outputs(self._estimator, now):
            self._senders[topic].publish(output)
        self._send_phase(now)

    def _send_phase(self, time_s: float) -> None:
        phase = self._estimator.phase(time_s)
        if phase is not self._phase:
            self._phase = phase
            self._phase_sender.publish(text_message(phase))

    def _send_datum(self) -> None:
        datum = self._estimator.datum
        if datum is not None and not self._datum_sent:
            self._datum_sent = True
            self._datum_sender.publish(datum_message(datum, now_s(self)))

    def _on_diagnostics(self) -> None:
        now = now_s(self)
        phase = self._estimator.phase(now)
        counts = {verdict.value: n for verdict, n in self._estimator.counts.items()}
        refused = sum(n for name, n in counts.items() if name != Verdict.ACCEPTED.value)
        self._senders[topics.DIAGNOSTICS].publish(
            diagnostics(
                now,
                "estimator",
                problem="no usable GPS fix" if phase is Phase.LOST else "",
                values={
                    "phase": phase,
                    **counts,
                    "refused": refused,
                    "refused_velocities": self._estimator.refused_velocities,
                    "withdrawn_corners": self._estimator.withdrawn_corners,
                },
            )
        )


def main() -> int:
    """Run the node."""
    return run_node("estimator", EstimatorNode)


if __name__ == "__main__":
    sys.exit(main())
