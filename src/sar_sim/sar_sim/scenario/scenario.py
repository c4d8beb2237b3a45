"""Scenarios: everything a simulated mission is made of, from YAML, checked strictly."""

from __future__ import annotations

import math
from dataclasses import MISSING, asdict, dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import yaml

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import blown_mps
from sar_planner.parameters.corner import CornerParameters
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
ODD_ACTIONS = ("other_way", "go_on", "break_off")


class ScenarioError(ValueError):
    """A scenario that cannot be flown; the message names file, key, value and expectation."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """The camera: altitude A [m], sweep beta [deg], redundancy f, footprint disc or square."""

    altitude_m: float = 150.0
    sweep_deg: float = 79.6
    redundancy: float = 0.0
    footprint: str = "disc"

    @property
    def radius_m(self) -> float:
        """Half the width of the strip one aircraft sees, A tan(beta / 2) [m]."""
        return self.altitude_m * math.tan(math.radians(self.sweep_deg) / 2.0)


@dataclass(frozen=True, slots=True)
class Pattern:
    """The expanding square: heading is a compass heading [deg]; ``turn_side`` 1 right, -1 left.

    ``track_spacing_m``: between the helicopter's neighbouring parallel tracks.
    """

    first_leg_m: float = 2000.0
    last_leg_m: float = 1500.0
    corners: int = 8
    heading_deg: float = 0.0
    turn_side: int = 1
    track_spacing_m: float = 500.0
    start_east_m: float = 0.0
    start_north_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Pilot:
    """How the pilot departs from the model: drawn leg by leg from the seed.

    ``speed_sigma_mps`` on each leg's speed, ``speed_drift_mps`` by how much it may drift along a
    leg, ``accel_spread`` (relative) on each corner's acceleration, ``corner_sigma_m`` on where he
    turns, ``turn_spread_deg`` by how much the angle may differ from 90 degrees, ``hover_s`` in
    every corner and up to ``hover_spread_s`` more. At corner ``odd_corner`` (from 1, 0 for none) he
    does ``odd_action``: other_way (turns to the other side), go_on (has slowed to a third half-way
    down the leg before, and gone on), break_off (flies away from the pattern, faster, for good).

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

    speed_sigma_mps: float = 0.0
    accel_spread: float = 0.0
    corner_sigma_m: float = 0.0
    hover_s: float = 0.0
    hover_spread_s: float = 0.0
    turn_spread_deg: float = 0.0
    speed_drift_mps: float = 0.0
    odd_corner: int = 0
    odd_action: str = "go_on"
    seed: int = 1
    kind: str = "robot"
    wander_along_mps: float = 0.0
    wander_across_mps: float = 0.0
    wander_time_s: float = 16.0
    wander_damping: float = 0.7
    gust_mps2: float = 0.0
    gust_time_s: float = 3.0
    heading_sigma_deg: float = 0.0
    buildup_s: float = 0.0
    accel_low_mps2: float = 1.2
    accel_high_mps2: float = 3.5
    accel_wobble: float = 0.0
    flare_mps: float = 0.0
    yaw_rate_dps: float = 0.0
    leave_early_deg: float = 0.0
    pass_share: float = 0.0
    pass_mps: float = 4.0
    roll_share: float = 0.0
    roll_mps: float = 12.0
    roll_spread_mps: float = 0.0
    bank_deg: float = 20.0

    @property
    def is_human(self) -> bool:
        """Whether he flies otherwise than in the paper's straight stretches."""
        return any(getattr(self, name) > 0.0 for name in HUMAN)


@dataclass(frozen=True, slots=True)
class Gps:
    """The receiver in the helicopter.

    ``sigma_m``: of white noise per axis; ``bias_sigma_m``, ``correlated_sigma_m``: of errors that
    wander, each a first-order Gauss-Markov process of ``bias_time_s``, ``correlated_time_s``.
    ``doppler_sigma_mps``: of velocity per axis, 0 for a receiver that gives none. What is stamped t
    is of ``latency_s`` + ``latency_per_mps_s`` x speed before t. ``dropout``: share of fixes lost.
    ``receiver``: plain, white, modern or old; in YAML it sets the defaults of the rest.
    """

    rate_hz: float = 1.0
    sigma_m: float = 0.0
    dropout: float = 0.0
    doppler_sigma_mps: float = 0.0
    seed: int = 1
    receiver: str = "plain"
    bias_sigma_m: float = 0.0
    bias_time_s: float = 60.0
    correlated_sigma_m: float = 0.0
    correlated_time_s: float = 5.0
    latency_s: float = 0.0
    latency_per_mps_s: float = 0.0

    @property
    def told_sigma_m(self) -> float:
        """The standard deviation per axis that the receiver gives of itself [m]."""
        return max(0.1, math.hypot(self.sigma_m, self.bias_sigma_m, self.correlated_sigma_m))


@dataclass(frozen=True, slots=True)
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
    autopilot: str = "ideal"
    min_radius_m: float = 80.0
    accel_limit_mps2: float = 1.0
    roll_lag_s: float = 0.0
    speed_lag_s: float = 0.0
    lookahead_m: float = 8.0
    l1_period_s: float = 15.0
    l1_damping: float = 0.75
    wp_radius_m: float = 50.0
    roll_limit_deg: float = 65.0
    turn_share: float = 0.79
    believed_radius_m: float = 0.0
    airspeed_min_mps: float = 10.0
    airspeed_max_mps: float = 30.0
    airspeed_ratio: float = 1.0
    loiter_radius_m: float = 80.0
    item_s: float = 0.0
    extra_path_min_m: float = 0.0
    extra_path_max_m: float = 0.0
    widest_radius_m: float = 0.0
    seed: int = 1


@dataclass(frozen=True, slots=True)
class Wind:
    """Wind: its mean, from a compass direction [deg], and gusts about it [m/s].

    Gusts have a standard deviation of ``gust_sigma_mps`` along each axis and die away with a time
    constant of ``gust_time_s`` (first-order, as Dryden's longitudinal gusts), drawn from ``seed``.
    """

    speed_mps: float = 0.0
    from_deg: float = 0.0
    gust_sigma_mps: float = 0.0
    gust_time_s: float = 15.0
    seed: int = 1

    @property
    def vector_mps(self) -> tuple[float, float]:
        """Where the mean wind blows to, east and north [m/s]."""
        return blown_mps(self.speed_mps, self.from_deg)


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that fails: ``component``, and how: ``kind``, from ``at_s`` on for ``for_s``.

    ``size``: of gps wrong the error [m], of clock wrong [s]; delayed the delay [s]; of slow one in
    how many gets through; of intermittent the share that is lost. An autopilot that was off boots
    anew; a wrong mode is one that a human chose. A node that is off is killed, one that is stuck is
    stopped, DDS that is off is cut: the launcher, not the simulation, does that.
    """

    component: str
    kind: str
    at_s: float
    for_s: float = 30.0
    size: float = 0.5

    def __post_init__(self) -> None:
        """Check what is asked for."""
        known = ", ".join(FAULTS)
        _expect("component", self.component, f"one of {known}", ok=self.component in FAULTS)
        kinds = FAULTS[self.component]
        _expect("kind", self.kind, f"one of {', '.join(kinds)}", ok=self.kind in kinds)
        for name in ("at_s", "for_s", "size"):
            value = getattr(self, name)
            if not (name == "size" and self.component == "clock"):
                _expect(name, value, "0 or more", ok=value >= 0.0)


@dataclass(frozen=True, slots=True)
class Scenario:
    """A whole mission."""

    name: str = "paper"
    datum: Datum = field(default_factory=lambda: Datum(37.8, -122.8, 0.0))
    corner: CornerParameters = field(default_factory=CornerParameters)
    sensor: Sensor = field(default_factory=Sensor)
    pattern: Pattern = field(default_factory=Pattern)
    pilot: Pilot = field(default_factory=Pilot)
    gps: Gps = field(default_factory=Gps)
    uav: Uav = field(default_factory=Uav)
    wind: Wind = field(default_factory=Wind)
    arc_spacing_m: float = 10.0
    faults: list[Fault] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Check every bound that the types do not."""
        _expect(
            "sensor.footprint",
            self.sensor.footprint,
            "disc or square",
            ok=self.sensor.footprint in ("disc", "square"),
        )
        _expect(
            "sensor.sweep_deg",
            self.sensor.sweep_deg,
            "between 0 and 180",
            ok=0.0 < self.sensor.sweep_deg < 180.0,
        )
        _expect(
            "sensor.redundancy",
            self.sensor.redundancy,
            "0 or more, less than 1",
            ok=0.0 <= self.sensor.redundancy < 1.0,
        )
        _expect(
            "pattern.turn_side",
            self.pattern.turn_side,
            "1 (right) or -1 (left)",
            ok=self.pattern.turn_side in (1, -1),
        )
        _expect(
            "pilot.odd_action",
            self.pilot.odd_action,
            f"one of {', '.join(ODD_ACTIONS)}",
            ok=self.pilot.odd_action in ODD_ACTIONS,
        )
        _expect(
            "pilot.kind",
            self.pilot.kind,
            f"one of {', '.join(PILOTS)}",
            ok=self.pilot.kind in PILOTS,
        )
        _expect(
            "gps.receiver",
            self.gps.receiver,
            f"one of {', '.join(RECEIVERS)}",
            ok=self.gps.receiver in RECEIVERS,
        )
        _expect(
            "pilot.roll_mps",
            self.pilot.roll_mps,
            "more than pilot.roll_spread_mps, with that less than corner.speed_mps",
            ok=self.pilot.roll_spread_mps
            < self.pilot.roll_mps
            < self.corner.speed_mps - self.pilot.roll_spread_mps,
        )
        _expect(
            "pilot.bank_deg",
            self.pilot.bank_deg,
            "between 0 and 60",
            ok=0.0 < self.pilot.bank_deg < 60.0,
        )
        for name in ("pass_share", "roll_share"):
            value = getattr(self.pilot, name)
            _expect(f"pilot.{name}", value, "0 to 1", ok=0.0 <= value <= 1.0)
        _expect("pattern.corners", self.pattern.corners, "1 or more", ok=self.pattern.corners >= 1)
        _expect("gps.rate_hz", self.gps.rate_hz, "0.5 to 10", ok=0.5 <= self.gps.rate_hz <= 10.0)
        _expect(
            "gps.dropout",
            self.gps.dropout,
            "0 or more, less than 1",
            ok=0.0 <= self.gps.dropout < 1.0,
        )
        _expect(
            "uav.autopilot",
            self.uav.autopilot,
            f"one of {', '.join(AUTOPILOTS)}",
            ok=self.uav.autopilot in AUTOPILOTS,
        )
        _expect(
            "uav.airspeed_min_mps",
            self.uav.airspeed_min_mps,
            "more than 0, less than uav.airspeed_max_mps",
            ok=0.0 < self.uav.airspeed_min_mps < self.uav.airspeed_max_mps,
        )
        _expect(
            "uav.roll_limit_deg",
            self.uav.roll_limit_deg,
            "between 0 and 90",
            ok=0.0 < self.uav.roll_limit_deg < 90.0,
        )
        _expect(
            "uav.min_radius_m",
            self.uav.min_radius_m,
            "not more than corner.turn_radius_m or uav.widest_radius_m, and more than 0",
            ok=0.0
            < self.uav.min_radius_m
            <= max(self.corner.turn_radius_m, self.uav.widest_radius_m),
        )
        _expect(
            "uav.extra_path_max_m",
            self.uav.extra_path_max_m,
            "not less than uav.extra_path_min_m",
            ok=self.uav.extra_path_max_m >= self.uav.extra_path_min_m,
        )
        for group, name in (
            ("sensor", "altitude_m"),
            ("pattern", "first_leg_m"),
            ("pattern", "last_leg_m"),
            ("pattern", "track_spacing_m"),
            ("uav", "accel_limit_mps2"),
            ("uav", "airspeed_ratio"),
            ("uav", "lookahead_m"),
            ("uav", "loiter_radius_m"),
            ("uav", "l1_period_s"),
            ("uav", "l1_damping"),
            ("uav", "wp_radius_m"),
            ("uav", "turn_share"),
            ("wind", "gust_time_s"),
            ("pilot", "wander_time_s"),
            ("pilot", "wander_damping"),
            ("pilot", "gust_time_s"),
            ("pilot", "accel_low_mps2"),
            ("gps", "bias_time_s"),
            ("gps", "correlated_time_s"),
        ):
            value = getattr(getattr(self, group), name)
            _expect(f"{group}.{name}", value, "more than 0", ok=value > 0.0)
        for group, name in (
            ("pilot", "speed_sigma_mps"),
            ("pilot", "accel_spread"),
            ("pilot", "corner_sigma_m"),
            ("pilot", "hover_s"),
            ("pilot", "hover_spread_s"),
            ("pilot", "turn_spread_deg"),
            ("pilot", "speed_drift_mps"),
            ("pilot", "odd_corner"),
            ("pilot", "wander_along_mps"),
            ("pilot", "wander_across_mps"),
            ("pilot", "gust_mps2"),
            ("pilot", "heading_sigma_deg"),
            ("pilot", "buildup_s"),
            ("pilot", "accel_wobble"),
            ("pilot", "flare_mps"),
            ("pilot", "yaw_rate_dps"),
            ("pilot", "leave_early_deg"),
            ("pilot", "pass_mps"),
            ("pilot", "roll_spread_mps"),
            ("gps", "bias_sigma_m"),
            ("gps", "correlated_sigma_m"),
            ("gps", "latency_s"),
            ("gps", "latency_per_mps_s"),
            ("gps", "sigma_m"),
            ("gps", "doppler_sigma_mps"),
            ("uav", "roll_lag_s"),
            ("uav", "speed_lag_s"),
            ("uav", "item_s"),
            ("uav", "extra_path_min_m"),
            ("uav", "widest_radius_m"),
            ("uav", "believed_radius_m"),
            ("wind", "speed_mps"),
            ("wind", "gust_sigma_mps"),
        ):
            value = getattr(getattr(self, group), name)
            _expect(f"{group}.{name}", value, "0 or more", ok=value >= 0.0)
        _expect("arc_spacing_m", self.arc_spacing_m, "0 or more", ok=self.arc_spacing_m >= 0.0)


# Which key of a part names what sets the defaults of its others.
PRESETS: dict[type, tuple[str, dict[str, dict[str, float]]]] = {
    Uav: ("autopilot", AUTOPILOTS),
    Pilot: ("kind", PILOTS),
    Gps: ("receiver", RECEIVERS),
}


def _expect(key: str, value: object, expected: str, *, ok: bool) -> None:
    if not ok:
        raise ScenarioError(f"{key} = {value}: expected {expected}")


def _convert(key: str, value: object, wanted: object) -> Any:
    """Return a YAML value as a field's type. Raises ``ScenarioError`` naming the key."""
    if isinstance(wanted, type) and is_dataclass(wanted):
        return _build(wanted, value, key)
    if get_origin(wanted) is list:
        if not isinstance(value, list):
            raise ScenarioError(f"{key} = {value!r}: expected a list")
        return [_convert(f"{key}[{i}]", item, get_args(wanted)[0]) for i, item in enumerate(value)]
    if wanted is str and isinstance(value, bool):
        value = "on" if value else "off"  # what YAML 1.1 makes of these words
    if wanted is str and isinstance(value, str):
        return value
    if value is None and wanted == (float | None):
        return None
    if wanted is not str and isinstance(value, int | float) and not isinstance(value, bool):
        if wanted is int and float(value).is_integer():
            return int(value)
        if wanted is not int and math.isfinite(value):
            return float(value)
    expected = "a text" if wanted is str else "a whole number" if wanted is int else "a number"
    raise ScenarioError(f"{key} = {value!r}: expected {expected}")


def _build(kind: Any, value: object, prefix: str) -> Any:
    if not isinstance(value, dict):
        raise ScenarioError(f"{prefix or 'scenario'} = {value!r}: expected a mapping")
    hints = get_type_hints(kind)
    given = {}
    for key, item in value.items():
        name = f"{prefix}.{key}" if prefix else str(key)
        if key not in hints:
            raise ScenarioError(f"{name}: unknown key, expected one of {', '.join(hints)}")
        given[key] = _convert(name, item, hints[key])
    for item in fields(kind):
        absent = item.name not in given
        if absent and item.default is MISSING and item.default_factory is MISSING:
            raise ScenarioError(f"{prefix}.{item.name}: missing")
    if kind in PRESETS:
        key, presets = PRESETS[kind]
        given = {**presets.get(given.get(key, ""), {}), **given}
    try:
        return kind(**given)
    except ScenarioError as error:
        raise ScenarioError(f"{prefix}.{error}" if prefix else str(error)) from error


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
    scenario: Scenario = _build(Scenario, document, "")
    return scenario


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
