"""The graph's topic and service names, each in one place."""

FIX = "/helicopter/fix"
VELOCITY = "/helicopter/vel"
FIX_VELOCITY = "/helicopter/fix_velocity"
ADSB = "/helicopter/adsb"
DATUM = "/datum"
HELICOPTER_ODOMETRY = "/helicopter/odometry"
HELICOPTER_ACCEL = "/helicopter/accel"
LEG = "/helicopter/leg"
CORNER = "/helicopter/corner"
PREDICTION = "/helicopter/prediction"
PHASE = "/helicopter/phase"
UAV_ODOMETRY = "/uav/odometry"
UAV_STATE = "/uav/state"
UAV_CLOCK = "/uav/clock"
WAYPOINTS = "/uav/waypoints"
CLEARED = "/uav/cleared"
SPEED = "/uav/speed"
UPLOADED = "/uav/uploaded"
AUTOPILOT = "/uav/autopilot"
WIND = "/uav/wind"
MODE = "/planner/mode"
LAG = "/planner/lag"
CORNER_PLAN = "/planner/corner"
CORNER_PATH = "/planner/path"
MISSION = "/planner/mission"
MONITOR = "/monitor/state"
SCENARIO = "/sim/scenario"
TARGET = "/target"
MARKS = "/planner/marks"
MARKERS = "/markers"
DIAGNOSTICS = "/diagnostics"
ENGAGE = "/planner/engage"
DISENGAGE = "/planner/disengage"
MARK = "/planner/mark"
ORBIT = "/planner/orbit"
RESUME = "/planner/resume"
RETURN_HOME = "/bridge/return_home"
TRUE_HELICOPTER = "/sim/helicopter"
TRUE_UAV = "/sim/uav"
TRUE_CORNER = "/sim/corner"
CLOCK = "/clock"

COMMON = frozenset(
    {
        FIX,
        VELOCITY,
        FIX_VELOCITY,
        ADSB,
        DATUM,
        HELICOPTER_ODOMETRY,
        HELICOPTER_ACCEL,
        LEG,
        CORNER,
        PREDICTION,
        PHASE,
        TARGET,
        SCENARIO,
        TRUE_HELICOPTER,
        TRUE_CORNER,
        CLOCK,
    }
)
"""The topics that all UAVs' nodes share, whatever their namespace."""


def name_of(topic: str) -> str:
    """Return a topic or service as a node names it: relative, but for what all UAVs share."""
    return topic if topic in COMMON else topic.removeprefix("/")
