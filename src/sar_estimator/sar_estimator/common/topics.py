"""The graph's topic and service names, each in one place."""

FIX = "/helicopter/fix"
FIX_TIME = "/helicopter/fix_time"
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
PATTERN = "/planner/pattern"
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
SET_PARAMETERS = "/planner/set_parameters_atomically"
RETURN_HOME = "/bridge/return_home"
TRUE_HELICOPTER = "/sim/helicopter"
TRUE_UAV = "/sim/uav"
TRUE_CORNER = "/sim/corner"
CLOCK = "/clock"

COMMON = frozenset(
    {
        FIX,
        FIX_TIME,
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


OF_UAV = (
    frozenset(
        value for key, value in list(globals().items()) if key.isupper() and isinstance(value, str)
    )
    - COMMON
)
"""The topics and services that every UAV has its own of."""


def name_of(topic: str) -> str:
    """Return a topic or service as a node names it: relative, where it is of its own UAV."""
    return topic.removeprefix("/") if topic in OF_UAV else topic


def of_uav(topic: str, name: str) -> str:
    """Return a topic of a named UAV; what all share, or is another one's already, as it is."""
    return f"/{name}{topic}" if name and topic in OF_UAV else topic


def plain(topic: str) -> str:
    """Return a topic without the name of the UAV that it is of."""
    rest = "/" + topic[1:].partition("/")[2]
    return rest if rest in OF_UAV else topic


def uav_of(topic: str) -> str:
    """Return the name of the UAV that a topic is of, empty where it bears none."""
    return topic.removesuffix(plain(topic)).strip("/")
