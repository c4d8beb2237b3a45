"""How near a path comes to all corners of a tube, bounded from below, compiled.

A *corner* is what a helicopter does from its nominal onset on: at V along its leg, from the onset
on with the deceleration s a to its stop, at once on its way out, with the acceleration s b to V. It
has four values: by how much its onset is later [s], s, V and the turn. A *box* of them is a table,
shape (4, 2), of least and greatest values.

At every time the way along the leg is the longer the later the onset, the less s and the greater V;
its extremes over a box are those of two corners, and grow apart with time. The way out is between
that of the earliest stop with the greatest s and V, and that of the latest stop with the least. So
a box's helicopter is within rho(t) of that of its middle, and rho grows with time. What a path
keeps from the middle (the straight between two times, less the bulge A h^2 / 8), less rho at the
end of each step, it keeps from the whole box. The box with the least bound is halved, until a
corner is known that comes about as near.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_planner.paths.apart_kernels import from_origin
from sar_planner.paths.flight_path import FloatArray

LATER_S, SHARE, SPEED_MPS, TURN_RAD = range(4)
(
    ONSET_X,  # where the helicopter is at the nominal onset [m]
    ONSET_Y,
    HEADING_RAD,  # of its leg
    SLOWING_MPS2,  # a
    LEAVING_MPS2,  # b
    BESIDE_M,  # how far beside all of this it may be
    NOMINAL,  # how many of these there are
) = range(7)
BOUND_M, WORST_S, BOXES = 8, 9, 10


@compiled("float64(float64, float64, float64, float64)")
def along_m(since_s: float, later_s: float, slowing: float, speed: float) -> float:
    """Return the way along the leg since the nominal onset, ``since_s`` >= 0."""
    if since_s <= later_s:
        return speed * since_s
    braked = min(since_s - later_s, speed / slowing)
    return speed * (later_s + braked) - 0.5 * slowing * braked * braked


@compiled("float64(float64, float64, float64, float64)")
def out_m(since_s: float, stop_s: float, leaving: float, speed: float) -> float:
    """Return the way out since a stop ``stop_s`` after the nominal onset."""
    after = max(since_s - stop_s, 0.0)
    ramp = min(after, speed / leaving)
    return 0.5 * leaving * ramp * ramp + speed * (after - ramp)


@compiled("float64(float64[:, ::1], float64[::1], float64[::1], float64)")
def reach_m(box: FloatArray, middle: FloatArray, nominal: FloatArray, since_s: float) -> float:
    """Return rho: how far any corner of a box is from that of its middle at a time."""
    a, b = nominal[SLOWING_MPS2], nominal[LEAVING_MPS2]
    later, share, speed = middle[LATER_S], middle[SHARE], middle[SPEED_MPS]
    along = along_m(since_s, later, share * a, speed)
    far = along_m(since_s, box[LATER_S, 1], box[SHARE, 0] * a, box[SPEED_MPS, 1])
    near = along_m(since_s, box[LATER_S, 0], box[SHARE, 1] * a, box[SPEED_MPS, 0])
    first_s = box[LATER_S, 0] + box[SPEED_MPS, 0] / (box[SHARE, 1] * a)
    last_s = box[LATER_S, 1] + box[SPEED_MPS, 1] / (box[SHARE, 0] * a)
    out = out_m(since_s, later + speed / (share * a), share * b, speed)
    most = out_m(since_s, first_s, box[SHARE, 1] * b, box[SPEED_MPS, 1])
    least = out_m(since_s, last_s, box[SHARE, 0] * b, box[SPEED_MPS, 0])
    turned = 2.0 * math.sin(0.25 * (box[TURN_RAD, 1] - box[TURN_RAD, 0]))
    beside: float = nominal[BESIDE_M]
    return max(far - along, along - near) + max(most - out, out - least) + turned * most + beside


@compiled(
    "Tuple((float64, float64, float64))(float64[:, ::1], float64, float64, float64[:, ::1],"
    " float64[::1], float64[::1], float64)"
)
def bound_of_box(
    flown: FloatArray,
    since_s: float,
    step_s: float,
    box: FloatArray,
    middle: FloatArray,
    nominal: FloatArray,
    bent_mps2: float,
) -> tuple[float, float, float]:
    """Return a box's bound [m], how near its middle comes [m], and when the bound is least [s].

    ``flown``: the UAV's positions, shape (n, 2), every ``step_s`` from ``since_s`` after the
    nominal onset; ``bent_mps2``: its most acceleration. ``middle``, shape (4,): is filled.
    """
    for i in range(4):
        middle[i] = 0.5 * (box[i, 0] + box[i, 1])
    slowing, leaving = middle[SHARE] * nominal[SLOWING_MPS2], middle[SHARE] * nominal[LEAVING_MPS2]
    later, speed = middle[LATER_S], middle[SPEED_MPS]
    stop_s = later + speed / slowing
    in_x, in_y = math.cos(nominal[HEADING_RAD]), math.sin(nominal[HEADING_RAD])
    heading = nominal[HEADING_RAD] + middle[TURN_RAD]
    out_x, out_y = math.cos(heading), math.sin(heading)
    bulge = 0.125 * step_s * step_s * (bent_mps2 + max(slowing, leaving))
    bound = nearest = math.inf
    worst_s = before_x = before_y = 0.0
    for i in range(flown.shape[0]):
        now = since_s + step_s * i
        along = along_m(now, later, slowing, speed)
        out = out_m(now, stop_s, leaving, speed)
        x = flown[i, 0] - nominal[ONSET_X] - along * in_x - out * out_x
        y = flown[i, 1] - nominal[ONSET_Y] - along * in_y - out * out_y
        nearest = min(nearest, math.sqrt(x * x + y * y))
        if i == 0:
            before_x, before_y = x, y
        kept = from_origin(before_x, before_y, x, y) - bulge - reach_m(box, middle, nominal, now)
        if kept < bound:
            bound, worst_s = kept, now
        before_x, before_y = x, y
    return max(bound, 0.0), nearest, worst_s


@compiled("int64(float64[:, ::1], float64[::1], float64[::1], float64)")
def _widest(box: FloatArray, middle: FloatArray, nominal: FloatArray, at_s: float) -> int:
    """Return which value of a box to halve: what then leaves the least reach at a time."""
    best, least = 0, math.inf
    for i in range(4):
        low, high = box[i, 0], box[i, 1]
        quarter = 0.25 * (high - low)
        box[i, 0], box[i, 1] = low + quarter, high - quarter
        reach = reach_m(box, middle, nominal, at_s)
        box[i, 0], box[i, 1] = low, high
        if reach < least:
            best, least = i, reach
    return best


@compiled(
    "Tuple((float64, float64, float64[:, ::1]))(float64[:, ::1], float64, float64,"
    " float64[:, ::1], float64[::1], float64, float64, int64)"
)
def least_in_box(
    flown: FloatArray,
    since_s: float,
    step_s: float,
    whole: FloatArray,
    nominal: FloatArray,
    bent_mps2: float,
    tolerance_m: float,
    halvings: int,
) -> tuple[float, float, FloatArray]:
    """Return a bound of the least distance over a box [m], how near one corner comes, and its box.

    The bound is certain; it is at most ``tolerance_m`` too low unless ``halvings`` did not suffice.
    """
    boxes = np.empty((halvings + 2, BOXES))
    box, middle = whole.copy(), np.empty(4)
    bound, nearest, worst_s = bound_of_box(flown, since_s, step_s, box, middle, nominal, bent_mps2)
    boxes[0, :4], boxes[0, 4:8] = box[:, 0], box[:, 1]
    boxes[0, BOUND_M], boxes[0, WORST_S] = bound, worst_s
    count, least = 1, 0
    while count <= halvings and boxes[least, BOUND_M] < nearest - tolerance_m:
        box[:, 0], box[:, 1] = boxes[least, :4], boxes[least, 4:8]
        for i in range(4):
            middle[i] = 0.5 * (box[i, 0] + box[i, 1])
        split = _widest(box, middle, nominal, boxes[least, WORST_S])
        low, high, cut = box[split, 0], box[split, 1], middle[split]
        for half in range(2):
            box[split, 0] = low if half == 0 else cut
            box[split, 1] = cut if half == 0 else high
            bound, near, worst_s = bound_of_box(
                flown, since_s, step_s, box, middle, nominal, bent_mps2
            )
            nearest = min(nearest, near)
            at = least if half == 0 else count
            boxes[at, :4], boxes[at, 4:8] = box[:, 0], box[:, 1]
            boxes[at, BOUND_M], boxes[at, WORST_S] = bound, worst_s
        count += 1
        least = int(np.argmin(boxes[:count, BOUND_M]))
    box[:, 0], box[:, 1] = boxes[least, :4], boxes[least, 4:8]
    return boxes[least, BOUND_M], nearest, box
