"""Paths from any pose onto the slot track, solved in closed form over grids of headings.

Every path is S(p) C S(y) C S(q) C C: straights and arcs of one radius, ending on the slot track in
its direction. The last arc is left out where it is not needed.

In the slot's frame (x along the slot track, the track itself on y = 0) two quantities decide
everything: the lateral way, which must bring the UAV to y = 0, and the detour kappa l - dx, by
which the UAV falls back against a slot that moves at V while the UAV flies at V / kappa. For given
headings between the arcs both are linear in the straights, so that two of these follow from a
system of two equations; what is left are the headings, searched on a grid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import Arc, FlightPath, FloatArray, Straight, places_after

TWO_PI = 2.0 * math.pi
COLUMNS = 7
STRAIGHT_P, STRAIGHT_Y, STRAIGHT_Q = 0, 2, 4
STRAIGHTS = [STRAIGHT_P, STRAIGHT_Y, STRAIGHT_Q]
TURNS = [1, 3, 5, 6]
SINGULAR = 1e-3


def radii_m(radius_m: float) -> FloatArray:
    """Return the radius of every part of a row, shape (7,) [m]; 0 for straights."""
    radii = np.zeros(COLUMNS)
    radii[TURNS] = radius_m
    return radii


@dataclass(frozen=True)
class PathBatch:
    """n paths from one pose; ``rows``, shape (n, 7): p [m], turn [rad], y, turn, q, turn, turn."""

    start: Pose
    radius_m: float
    rows: FloatArray

    def __len__(self) -> int:
        """How many paths."""
        return len(self.rows)

    def take(self, chosen: NDArray[np.bool_] | NDArray[np.intp] | Sequence[int]) -> PathBatch:
        """Return some of the paths."""
        return PathBatch(self.start, self.radius_m, self.rows[chosen])

    @staticmethod
    def join(batches: Sequence[PathBatch]) -> PathBatch:
        """Return the paths of all batches; they share start and radius."""
        first = batches[0]
        return PathBatch(first.start, first.radius_m, np.vstack([batch.rows for batch in batches]))

    @property
    def start_values(self) -> FloatArray:
        """Where they start: x [m], y [m] and heading [rad] of the start, shape (3,)."""
        return np.array((self.start.x_m, self.start.y_m, self.start.heading_rad))

    @cached_property
    def _parts_m(self) -> FloatArray:
        lengths = np.abs(self.rows)
        lengths[:, TURNS] *= self.radius_m
        return lengths

    @cached_property
    def lengths_m(self) -> FloatArray:
        """Length of every path, shape (n,) [m]."""
        total: FloatArray = self._parts_m.sum(axis=1)
        return total

    @cached_property
    def _joints(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """x, y and heading where every part begins, and the end: shapes (n, 8)."""
        n = len(self.rows)
        heading = np.empty((n, COLUMNS + 1))
        heading[:, 0] = self.start.heading_rad
        half_turns = 0.5 * self.rows
        half_turns[:, STRAIGHTS] = 0.0
        np.cumsum(half_turns, axis=1, out=heading[:, 1:])
        heading[:, 1:] *= 2.0
        heading[:, 1:] += self.start.heading_rad
        half = heading[:, :-1] + half_turns
        chord = np.abs(self.rows)
        chord[:, TURNS] = 2.0 * self.radius_m * np.sin(0.5 * chord[:, TURNS])
        x, y = np.empty((n, COLUMNS + 1)), np.empty((n, COLUMNS + 1))
        x[:, 0], y[:, 0] = self.start.x_m, self.start.y_m
        np.cumsum(chord * np.cos(half), axis=1, out=x[:, 1:])
        np.cumsum(chord * np.sin(half), axis=1, out=y[:, 1:])
        x[:, 1:] += self.start.x_m
        y[:, 1:] += self.start.y_m
        return x, y, heading

    @property
    def ends(self) -> FloatArray:
        """Where the paths end, shape (n, 2) [m]."""
        x, y, _ = self._joints
        return np.column_stack((x[:, -1], y[:, -1]))

    def points(self, distances_m: FloatArray) -> FloatArray:
        """Return positions, shape (n, m, 2) [m], at distances flown, shape (m,) or (n, m)."""
        x, y, heading = self._joints
        flown = np.broadcast_to(distances_m, (len(self.rows), distances_m.shape[-1]))
        ends = np.cumsum(self._parts_m, axis=1)
        # Which part every point is on, as an index into the flattened joints.
        part = np.zeros(flown.shape, dtype=np.int8)
        for column in range(COLUMNS):
            part += flown >= ends[:, column : column + 1]
        at = np.arange(len(self.rows))[:, None] * (COLUMNS + 1) + part
        begins = np.zeros_like(x)
        begins[:, 1:] = ends
        curvature = np.zeros_like(x)
        curvature[:, TURNS] = np.sign(self.rows[:, TURNS]) / self.radius_m
        return places_after(
            x.take(at), y.take(at), heading.take(at), curvature.take(at), flown - begins.take(at)
        )

    def path(self, index: int) -> FlightPath:
        """Return one path."""
        p, turn_1, y, turn_2, q, turn_3, turn_4 = (float(value) for value in self.rows[index])
        r = self.radius_m
        return FlightPath.of(
            self.start,
            (
                Straight(p),
                Arc(r, turn_1),
                Straight(y),
                Arc(r, turn_2),
                Straight(q),
                Arc(r, turn_3),
                Arc(r, turn_4),
            ),
        )


def turn_to(heading_rad: FloatArray, target_rad: float | FloatArray, side: int) -> FloatArray:
    """Return the signed turns [rad], |turn| < 2 pi, from headings to a heading by one side."""
    turn = np.mod(side * (target_rad - heading_rad), TWO_PI)
    return side * np.where(turn > TWO_PI - 1e-9, 0.0, turn)


@dataclass(frozen=True)
class Arcs:
    """What the arcs of n intercepts do, whatever their straights.

    ``turns_rad``: the first three; ``sines``, ``cosines``: of the headings on the straights, by
    column; ``lateral_m``, ``forward_m``: their way across and along the slot track; ``length_m``.
    Shapes (n,). The same at any speed.
    """

    turns_rad: tuple[FloatArray, FloatArray, FloatArray]
    sines: dict[int, FloatArray]
    cosines: dict[int, FloatArray]
    lateral_m: FloatArray
    forward_m: FloatArray
    length_m: FloatArray


@dataclass(frozen=True)
class InterceptProblem:
    """From ``start``, in the slot's frame (track on y = 0, direction +x), onto the slot track.

    ``slow_factor``: kappa = V / speed of the UAV along its path. ``last_turn_rad``: the last arc, 0
    for none, one for all paths or one for each. ``lead_factor``: kappa on the first straight where
    it is another one.
    """

    start: Pose
    radius_m: float
    slow_factor: float = 1.0
    last_turn_rad: float | FloatArray = 0.0
    lead_factor: float | None = None

    @property
    def _lead_factor(self) -> float:
        return self.slow_factor if self.lead_factor is None else self.lead_factor

    def arcs(self, turn_1: FloatArray, turn_2: FloatArray, last_side: int) -> Arcs:
        """Return the arcs of two turns [rad], shape (n,), a third to ``last_side`` and the last."""
        h1 = self.start.heading_rad + turn_1
        h2 = h1 + turn_2
        turn_3 = turn_to(h2, -self.last_turn_rad, last_side)
        h3 = h2 + turn_3
        turn_4 = np.broadcast_to(self.last_turn_rad, h3.shape)
        headings = (h1, h2, h3, h3 + turn_4)
        begun = np.array((self.start.heading_rad,))
        sines = [np.full_like(h1, np.sin(begun)), *(np.sin(heading) for heading in headings)]
        cosines = [np.full_like(h1, np.cos(begun)), *(np.cos(heading) for heading in headings)]
        r = self.radius_m
        lateral = np.zeros_like(h1)
        forward = np.zeros_like(h1)
        for i, turn in enumerate((turn_1, turn_2, turn_3, turn_4)):
            side = np.sign(turn) * r
            lateral += side * (cosines[i] - cosines[i + 1])
            forward += side * (sines[i + 1] - sines[i])
        length = r * (np.abs(turn_1) + np.abs(turn_2) + np.abs(turn_3) + np.abs(turn_4))
        return Arcs(
            (turn_1, turn_2, turn_3),
            dict(zip(STRAIGHTS, sines[:3], strict=True)),
            dict(zip(STRAIGHTS, cosines[:3], strict=True)),
            lateral,
            forward,
            length,
        )

    def solve(
        self,
        arcs: Arcs,
        detour_m: float,
        *,
        straights: tuple[int, int] = (STRAIGHT_Y, STRAIGHT_Q),
        lead_m: float = 0.0,
    ) -> PathBatch:
        """Return the paths of these arcs with exactly this detour [m].

        ``straights``: which two are solved for; of the others p is ``lead_m`` and q is 0. Rows
        without a solution of straights not below 0 (p not below ``lead_m``) are dropped.
        """
        k, h0 = self.slow_factor, self.start.heading_rad
        want_y = -self.start.y_m - arcs.lateral_m - lead_m * math.sin(h0)
        arcs_m = k * arcs.length_m - arcs.forward_m
        want_e = detour_m - arcs_m - lead_m * (self._lead_factor - math.cos(h0))
        a11, a12 = (arcs.sines[column] for column in straights)
        factors = {STRAIGHT_P: self._lead_factor, STRAIGHT_Y: k, STRAIGHT_Q: k}
        a21, a22 = (factors[column] - arcs.cosines[column] for column in straights)
        det = a11 * a22 - a12 * a21
        exists = np.abs(det) >= SINGULAR
        safe = np.where(exists, det, np.inf)
        solved = ((want_y * a22 - a12 * want_e) / safe, (a11 * want_e - a21 * want_y) / safe)
        return self._batch(arcs, dict(zip(straights, solved, strict=True)), lead_m, exists=exists)

    def reach(self, arcs: Arcs, *, straight: int = STRAIGHT_Y, lead_m: float = 0.0) -> PathBatch:
        """Return the paths of these arcs with one straight free, whatever their detour."""
        sine = arcs.sines[straight]
        want = -self.start.y_m - arcs.lateral_m - lead_m * math.sin(self.start.heading_rad)
        exists = np.abs(sine) >= SINGULAR
        length = want / np.where(exists, sine, np.inf)
        return self._batch(arcs, {straight: length}, lead_m, exists=exists)

    def _batch(
        self,
        arcs: Arcs,
        solved: dict[int, FloatArray],
        lead_m: float,
        *,
        exists: NDArray[np.bool_],
    ) -> PathBatch:
        """Return the paths that exist with none of the straights solved for below its least."""
        rows = np.zeros((len(exists), COLUMNS))
        rows[:, STRAIGHT_P] = lead_m
        rows[:, 1], rows[:, 3], rows[:, 5] = arcs.turns_rad
        rows[:, 6] = self.last_turn_rad
        good = exists
        for column, length in solved.items():
            rows[:, column] += length
            least = lead_m if column == STRAIGHT_P else 0.0
            good = good & (rows[:, column] >= least - 1e-9)
        rows = rows[good]
        rows[:, STRAIGHTS] = np.maximum(rows[:, STRAIGHTS], 0.0)
        return PathBatch(self.start, self.radius_m, rows)

    def detours_m(self, batch: PathBatch) -> FloatArray:
        """Return the detour kappa l - dx of every path, shape (n,) [m]."""
        lead = batch.rows[:, STRAIGHT_P]
        weighed = self.slow_factor * (batch.lengths_m - lead) + self._lead_factor * lead
        return weighed - (batch.ends[:, 0] - self.start.x_m)


def row_of(path: FlightPath) -> FloatArray | None:
    """Return a path as a row of ``PathBatch``, shape (7,); None where it is no such path."""
    row = np.zeros(COLUMNS)
    kinds = (Straight, Arc, Straight, Arc, Straight, Arc, Arc)
    column = 0
    for part in path.segments:
        while column < COLUMNS and not isinstance(part, kinds[column]):
            column += 1
        if column == COLUMNS:
            return None
        row[column] = part.turn_rad if isinstance(part, Arc) else part.length_m
        column += 1
    return row
