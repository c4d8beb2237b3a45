"""Scenarios: everything a simulated mission is made of, from YAML, checked strictly."""

from __future__ import annotations

import math
from dataclasses import asdict, field
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import (
    CHECKED,
    NotNegative,
    Positive,
    Share,
    Side,
    Word,
    read,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose, blown_mps
from sar_planner.parameters.corner import CornerParameters
from sar_planner.patterns.legs import CORNERS, PatternKind, PatternTerms
from sar_sim.scenario.formation import Member, fault_of
from sar_sim.scenario.presets import AUTOPILOTS, HUMAN, PILOTS, RECEIVERS

# The nodes that lead the UAV: they can fail, and are started again.
NODES = ("estimator", "planner", "monitor", "bridge")
# What can fail, and how, in PX4's words.
FAULTS: dict[str, tuple[str, ...]] = {
    "gps": ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"),
    "radio": ("off", "slow", "intermittent"),
    "autopilot": ("off",),
    "mode": ("wrong",),
    "clock": ("wrong",),
    "dds": ("off",),
    **dict.fromkeys(NODES, ("off", "stuck")),
}
Anomaly = Literal["other_way", "go_on", "break_off"]
FindKind = Literal["goes_on", "hovers", "circles", "stays"]
PilotKind = Literal["robot", "steady", "human", "rough"]
Receiver = Literal["plain", "white", "modern", "old"]
AutopilotKind = Literal["ideal", "arduplane", "piccolo2005"]


class ScenarioError(ValueError):
    """A scenario that cannot be flown; the message names file, key, value and expectation."""


@dataclass(frozen=True, slots=True, config=CHECKED)
class Sensor:
    """The camera: altitude A [m], sweep beta [deg], redundancy f, footprint disc or square."""

    altitude_m: Positive = 150.0
    sweep_deg: Annotated[float, Field(gt=0.0, lt=180.0)] = 79.6
    redundancy: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    footprint: Literal["disc", "square"] = "disc"

    @property
    def radius_m(self) -> float:
        """Half the width of the strip one aircraft sees, A tan(beta / 2) [m]."""
        return self.altitude_m * math.tan(math.radians(self.sweep_deg) / 2.0)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Pattern:
    """The search pattern, begun at ``start_east_m``, ``start_north_m`` from the datum.

    ``kind``: expanding_square, sector, parallel_track, creeping_line, track_line or
    track_line_return. ``heading_deg``: compass heading of the first leg; ``turn_side``: to which
    side it ends, 1 right, -1 left. ``first_leg_m``: its length; the radius of a sector search, the
    length of every search leg of the others. ``last_leg_m``: of an expanding square.
    ``track_spacing_m``: between the helicopter's neighbouring parallel tracks. ``corners``: how
    many; none in a track line, two in one that is flown back.
    """

    first_leg_m: Positive = 2000.0
    last_leg_m: Positive = 1500.0
    corners: Annotated[int, Field(ge=0)] = 8
    heading_deg: float = 0.0
    turn_side: Side = 1
    track_spacing_m: Positive = 500.0
    start_east_m: float = 0.0
    start_north_m: float = 0.0
    kind: PatternKind = "expanding_square"

    @property
    def start(self) -> Pose:
        """Where its first leg begins, and leads to."""
        heading_rad = math.radians(90.0 - self.heading_deg)
        return Pose(self.start_east_m, self.start_north_m, heading_rad)

    @property
    def terms(self) -> PatternTerms:
        """What is known of it beforehand."""
        return PatternTerms(self.kind, self.turn_side, self.first_leg_m, self.track_spacing_m)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Pilot:
    """How the pilot departs from the model: drawn leg by leg from the seed.

    ``speed_sigma_mps`` on each leg's speed, ``speed_drift_mps`` by how much it may drift along a
    leg, ``accel_spread`` (relative) on each corner's acceleration, ``corner_sigma_m`` on where he
    turns, ``turn_spread_deg`` by how much the angle may differ from 90 degrees, ``hover_s`` in
    every corner and up to ``hover_spread_s`` more. At corner ``anomaly_corner`` (from 1, 0 for
    none) he does ``anomaly``: other_way (turns to the other side), go_on (has slowed to a third
    half-way down the leg before, and gone on), break_off (flies away from the pattern, faster, for
    good).

    ``kind``: robot, steady, human or rough; in YAML it sets the defaults of the rest.

    ``wander_along_mps``, ``wander_across_mps``: rms of the velocity with which he wanders about
    his line and speed, each a second-order Gauss-Markov process of natural frequency
    1 / ``wander_time_s`` and damping ``wander_damping`` (the line is regained as the offset dies
    away). ``gust_mps2``: rms of a first-order disturbance of ``gust_time_s``.
    ``heading_sigma_deg``: by which a leg's course is held wrong. ``buildup_s``: in which a
    deceleration builds up, a third more or less; it stays between ``accel_low_mps2`` and
    ``accel_high_mps2``, varies by the share ``accel_wobble`` (1.5 s), and is eased off below
    ``flare_mps`` above the speed it ends at. ``yaw_rate_dps``: of turns on the spot, 0 for at once.
    ``leave_early_deg``: of the turn is still to come when he speeds up. A share ``pass_share`` of
    corners is passed at ``pass_mps``, without a stop; a share ``roll_share`` is rolled: turned
    with ``bank_deg`` at ``roll_mps``, ``roll_spread_mps`` more or less.
    """

    speed_sigma_mps: NotNegative = 0.0
    accel_spread: NotNegative = 0.0
    corner_sigma_m: NotNegative = 0.0
    hover_s: NotNegative = 0.0
    hover_spread_s: NotNegative = 0.0
    turn_spread_deg: NotNegative = 0.0
    speed_drift_mps: NotNegative = 0.0
    anomaly_corner: Annotated[int, Field(ge=0)] = 0
    anomaly: Anomaly = "go_on"
    seed: int = 1
    kind: PilotKind = "robot"
    wander_along_mps: NotNegative = 0.0
    wander_across_mps: NotNegative = 0.0
    wander_time_s: Positive = 16.0
    wander_damping: Positive = 0.7
    gust_mps2: NotNegative = 0.0
    gust_time_s: Positive = 3.0
    heading_sigma_deg: NotNegative = 0.0
    buildup_s: NotNegative = 0.0
    accel_low_mps2: Positive = 1.2
    accel_high_mps2: float = 3.5
    accel_wobble: NotNegative = 0.0
    flare_mps: NotNegative = 0.0
    yaw_rate_dps: NotNegative = 0.0
    leave_early_deg: NotNegative = 0.0
    pass_share: Share = 0.0
    pass_mps: NotNegative = 4.0
    roll_share: Share = 0.0
    roll_mps: float = 12.0
    roll_spread_mps: NotNegative = 0.0
    bank_deg: Annotated[float, Field(gt=0.0, lt=60.0)] = 20.0

    @property
    def is_human(self) -> bool:
        """Whether he flies otherwise than in the paper's straight stretches."""
        return any(getattr(self, name) > 0.0 for name in HUMAN)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Gps:
    """The receiver in the helicopter.

    ``sigma_m``: of white noise per axis; ``bias_sigma_m``, ``correlated_sigma_m``: of errors that
    wander, each a first-order Gauss-Markov process of ``bias_time_s``, ``correlated_time_s``.
    ``doppler_sigma_mps``: of velocity per axis, 0 for a receiver that gives none. What is stamped t
    is of ``latency_s`` + ``latency_per_mps_s`` x speed before t. ``dropout``: share of fixes lost.
    ``receiver``: plain, white, modern or old; in YAML it sets the defaults of the rest.
    """

    rate_hz: Annotated[float, Field(ge=0.5, le=10.0)] = 1.0
    sigma_m: NotNegative = 0.0
    dropout: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    doppler_sigma_mps: NotNegative = 0.0
    seed: int = 1
    receiver: Receiver = "plain"
    bias_sigma_m: NotNegative = 0.0
    bias_time_s: Positive = 60.0
    correlated_sigma_m: NotNegative = 0.0
    correlated_time_s: Positive = 5.0
    latency_s: NotNegative = 0.0
    latency_per_mps_s: NotNegative = 0.0

    @property
    def reported_sigma_m(self) -> float:
        """The standard deviation per axis that the receiver gives of itself [m]."""
        return max(0.1, math.hypot(self.sigma_m, self.bias_sigma_m, self.correlated_sigma_m))


@dataclass(frozen=True, slots=True, config=CHECKED)
class Uav:
    """The unmanned aeroplane: where it starts and how it flies.

    ``extra_path_min_m``, ``extra_path_max_m``: at every corner, from its first turn on, the UAV
    oscillates about its path, until it has flown so much more than it made good (drawn evenly from
    ``seed``): the error of the paper's hardware-in-the-loop runs. ``lag_m``: L(1). ``autopilot``:
    ideal (the paper's kinematic model), arduplane, or piccolo2005 (overestimates its turn rate);
    in YAML it also sets defaults. ``roll_lag_s``, ``speed_lag_s``: time constants of turn rate and
    airspeed, 0 for none. Of ideal only, ``min_radius_m``: tightest turn at cruise speed; where
    ``widest_radius_m`` is larger, the tightest turn is drawn anew at every corner, evenly between
    the two, from ``seed`` (a turn rate that is overestimated, as the paper has it);
    ``lookahead_m``: of the path follower. Of the others, ``l1_period_s``, ``l1_damping``,
    ``wp_radius_m``, ``roll_limit_deg``: NAVL1_PERIOD, NAVL1_DAMPING, WP_RADIUS, ROLL_LIMIT_DEG;
    ``turn_share``: turn rate over that of a coordinated turn at the same bank;
    ``believed_radius_m``: turn radius that legs are left for, 0 to leave them by WP_RADIUS.
    ``item_s``: what the transfer of one waypoint takes offline. ``airspeed_min_mps``,
    ``airspeed_max_mps``: its envelope, indicated; ``airspeed_ratio``: true airspeed over it.
    """

    lag_m: float = 800.0
    autopilot: AutopilotKind = "ideal"
    min_radius_m: Positive = 80.0
    accel_limit_mps2: Positive = 1.0
    roll_lag_s: NotNegative = 0.0
    speed_lag_s: NotNegative = 0.0
    lookahead_m: Positive = 8.0
    l1_period_s: Positive = 15.0
    l1_damping: Positive = 0.75
    wp_radius_m: Positive = 50.0
    roll_limit_deg: Annotated[float, Field(gt=0.0, lt=90.0)] = 65.0
    turn_share: Positive = 0.79
    believed_radius_m: NotNegative = 0.0
    airspeed_min_mps: Positive = 10.0
    airspeed_max_mps: Positive = 30.0
    airspeed_ratio: Positive = 1.0
    loiter_radius_m: Positive = 80.0
    item_s: NotNegative = 0.0
    extra_path_min_m: NotNegative = 0.0
    extra_path_max_m: NotNegative = 0.0
    widest_radius_m: NotNegative = 0.0
    seed: int = 1


@dataclass(frozen=True, slots=True, config=CHECKED)
class Wind:
    """Wind: its mean, from a compass direction [deg], and gusts about it [m/s].

    Gusts have a standard deviation of ``gust_sigma_mps`` along each axis and die away with a time
    constant of ``gust_time_s`` (first-order, as Dryden's longitudinal gusts), drawn from ``seed``.
    """

    speed_mps: NotNegative = 0.0
    from_deg: float = 0.0
    gust_sigma_mps: NotNegative = 0.0
    gust_time_s: Positive = 15.0
    seed: int = 1

    @property
    def vector_mps(self) -> tuple[float, float]:
        """Where the mean wind blows to, east and north [m/s]."""
        return blown_mps(self.speed_mps, self.from_deg)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Fault:
    """Something that fails: ``component``, and how: ``kind``, from ``at_s`` on for ``for_s``.

    ``size``: of gps wrong the error [m], of clock wrong [s]; delayed the delay [s]; of slow one in
    how many gets through; of intermittent the share that is lost. An autopilot that was off boots
    anew; a wrong mode is one that a human chose. A node that is off is killed, one that is stuck is
    stopped, DDS that is off is cut: the launcher, not the simulation, does that.
    """

    component: str
    kind: Word
    at_s: NotNegative
    for_s: NotNegative = 30.0
    size: float = 0.5

    def __post_init__(self) -> None:
        """Check what goes together."""
        known = self.component in FAULTS
        _expect("component", self.component, f"one of {', '.join(FAULTS)}", known)
        kinds = FAULTS[self.component]
        _expect("kind", self.kind, f"one of {', '.join(kinds)}", self.kind in kinds)
        # A clock may be wrong by either sign.
        _expect("size", self.size, "0 or more", self.component == "clock" or self.size >= 0.0)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Find:
    """Somebody is seen at ``time_s``, marked, and orbited for ``orbit_s``; then the UAV resumes.

    ``ahead_m``, ``left_m``: where, from the helicopter; 0, 0: under it. ``helicopter``: goes_on on
    its pattern; or flies to the mark, and hovers or circles there for ``hover_s`` before it takes
    its pattern up again; or stays there (it may land) to the end.
    """

    time_s: NotNegative
    orbit_s: Positive = 300.0
    ahead_m: float = 0.0
    left_m: float = 0.0
    helicopter: FindKind = "goes_on"
    hover_s: NotNegative = 120.0


@dataclass(frozen=True, slots=True, config=CHECKED)
class Scenario:
    """A whole mission. ``layer_m``: between the altitudes of the formation's UAVs."""

    name: Word = "paper"
    datum: Datum = field(default_factory=lambda: Datum(37.8, -122.8, 0.0))
    corner: CornerParameters = field(default_factory=CornerParameters)
    sensor: Sensor = field(default_factory=Sensor)
    pattern: Pattern = field(default_factory=Pattern)
    pilot: Pilot = field(default_factory=Pilot)
    gps: Gps = field(default_factory=Gps)
    uav: Uav = field(default_factory=Uav)
    wind: Wind = field(default_factory=Wind)
    arc_spacing_m: NotNegative = 10.0
    faults: list[Fault] = field(default_factory=list)
    finds: list[Find] = field(default_factory=list)
    formation: list[Member] = field(default_factory=lambda: [Member()])
    layer_m: NotNegative = 60.0

    def altitude_m(self, number: int) -> float:
        """Return the altitude of the formation's UAV of a number (from 0) [m]."""
        return self.sensor.altitude_m + number * self.layer_m

    def before(self, number: int) -> list[str]:
        """Return the names of the UAVs that have the right of way over one."""
        return [one.name for one in self.formation[:number]]

    def others(self, number: int) -> list[str]:
        """Return the names of the UAVs beside one."""
        return self.before(number) + [one.name for one in self.formation[number + 1 :]]

    def planner_parameters(self, number: int, *, recorded: bool) -> dict[str, Any]:
        """Return what is prescribed to a UAV's planner, beside the corner's parameters.

        ``recorded``: the helicopter's track, which follows no pattern of known lengths.
        """
        member, pattern = self.formation[number], self.pattern
        return {
            "pattern": pattern.kind,
            "turn_side": pattern.turn_side,
            "first_leg_m": 0.0 if recorded else pattern.first_leg_m,
            "track_spacing_m": pattern.track_spacing_m,
            "slot_side": member.side,
            "slot_tracks": member.tracks,
            "arc_spacing_m": self.arc_spacing_m,
        }

    def __post_init__(self) -> None:
        """Check what goes together."""
        wrong = fault_of(self.formation)
        if wrong is not None:
            _expect(*wrong, ok=False)
        pilot, uav = self.pilot, self.uav
        wanted = CORNERS.get(self.pattern.kind)
        corners = self.pattern.corners
        expected = "1 or more" if wanted is None else f"{wanted} in a {self.pattern.kind}"
        ok = corners >= 1 if wanted is None else corners == wanted
        _expect("pattern.corners", corners, expected, ok)
        _expect(
            "pilot.roll_mps",
            pilot.roll_mps,
            "more than pilot.roll_spread_mps, with that less than corner.speed_mps",
            pilot.roll_spread_mps < pilot.roll_mps < self.corner.speed_mps - pilot.roll_spread_mps,
        )
        _expect(
            "uav.airspeed_min_mps",
            uav.airspeed_min_mps,
            "less than uav.airspeed_max_mps",
            uav.airspeed_min_mps < uav.airspeed_max_mps,
        )
        _expect(
            "uav.min_radius_m",
            uav.min_radius_m,
            "not more than corner.turn_radius_m or uav.widest_radius_m",
            uav.min_radius_m <= max(self.corner.turn_radius_m, uav.widest_radius_m),
        )
        _expect(
            "uav.extra_path_max_m",
            uav.extra_path_max_m,
            "not less than uav.extra_path_min_m",
            uav.extra_path_max_m >= uav.extra_path_min_m,
        )


def _expect(key: str, value: object, expected: str, ok: bool) -> None:  # noqa: FBT001
    if not ok:
        raise ScenarioError(f"{key} = {value!r}: expected {expected}")


# Which key of which part names what sets the defaults of its others.
PRESETS: tuple[tuple[str, str, dict[str, dict[str, float]]], ...] = (
    ("uav", "autopilot", AUTOPILOTS),
    ("pilot", "kind", PILOTS),
    ("gps", "receiver", RECEIVERS),
)


def _with_presets(document: dict[str, Any]) -> dict[str, Any]:
    """Return a document in which what is not said of a part is as its kind has it."""
    filled = dict(document)
    for part, key, presets in PRESETS:
        given = document.get(part)
        if isinstance(given, dict) and isinstance(given.get(key), str):
            filled[part] = {**presets.get(given[key], {}), **given}
    return filled


def read_document(path: Path) -> dict[str, Any]:
    """Read a YAML file that holds a mapping, or nothing. Raises ``ScenarioError`` in one line."""
    try:
        loaded = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"{path}: {error.strerror}") from error
    except Exception as error:  # PyYAML lets out whatever its constructors raise
        raise ScenarioError(f"{path}: not YAML: {' '.join(str(error).split())}") from error
    document = {} if loaded is None else loaded
    if not isinstance(document, dict):
        raise ScenarioError(f"{path}: {document!r}: expected a mapping")
    return document


def scenario_of(document: dict[str, Any]) -> Scenario:
    """Return the scenario that a document describes. Raises ``ScenarioError`` naming the key."""
    try:
        return read(Scenario, _with_presets(document))
    except ValueError as error:
        raise ScenarioError(str(error)) from error


def load_scenario(path: Path) -> Scenario:
    """Read a scenario file. Raises ``ScenarioError`` in one line."""
    document = read_document(path)
    try:
        return scenario_of(document)
    except ValueError as error:
        raise ScenarioError(f"{path}: {error}") from error


def scenario_document(scenario: Scenario) -> dict[str, Any]:
    """Return a scenario as plain values, such that ``load_scenario`` reads it back the same."""
    return asdict(scenario)
