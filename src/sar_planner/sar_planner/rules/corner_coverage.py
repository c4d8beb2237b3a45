"""How much of the UAV's two swaths about a corner a path leaves uncovered.

In the frame of the new slot track, which the old one crosses d tan(theta / 2) from its origin,
theta being the turn: the old swath comes up to there, the new one leads away along y = 0, each d
wide. A disc of d / 2 about the UAV sees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.kernels import uncovered_cells
from sar_planner.paths.slot_intercept import PathBatch, radii_m

CELL = 0.12
LANES = (-0.42, -0.25, -0.08, 0.08, 0.25, 0.42)
LANE = 1.0 / 6.0
REACH = 2.5
SAMPLE = 0.12


class CornerSweep:
    """Cells of both swaths about a corner, for one track spacing d [m] and one turn [rad]."""

    def __init__(self, spacing_m: float, turn_rad: float) -> None:
        """Lay the cells out; the place in which the swaths cross belongs to the old one."""
        d = self._d = spacing_m
        along, lane = (
            grid.ravel()
            for grid in np.meshgrid(np.arange(0.5 * CELL, REACH, CELL), LANES, indexing="ij")
        )
        on = 0.5 - along
        # What neither the old track's end nor the new one's begin would see of the outer corner.
        kept = (on <= 0.0) | (np.hypot(on, lane) <= 0.5)
        self._way = np.array((math.cos(turn_rad), math.sin(turn_rad)))
        across = np.array((self._way[1], -self._way[0]))
        crossing = np.array((math.tan(0.5 * turn_rad), 0.0))
        old = crossing + on[:, None] * self._way + lane[:, None] * across
        new = np.column_stack((0.5 + along, lane))
        shared = (np.abs(new @ across) < 0.5) & (new @ self._way < 0.5)
        self._old, self._new = d * old[kept], d * (crossing + new[~shared])
        self._cell_m2 = CELL * LANE * d**2

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area [m^2] that every path leaves uncovered, shape (n,), to about a cell.

        Before its start the old track was flown, after its end the new one will be.
        """
        begun = float(self._way @ (batch.start.x_m, batch.start.y_m))
        old = self._old[self._old @ self._way > begun]
        cells = uncovered_cells(
            batch.rows,
            batch.start_values,
            radii_m(batch.radius_m),
            np.vstack((old, self._new)),
            len(old),
            SAMPLE * self._d,
            0.5 * self._d,
            LANE * self._d,
        )
        return cells * self._cell_m2


@lru_cache(maxsize=8)
def sweep_of(spacing_m: float, turn_rad: float = 0.5 * math.pi) -> CornerSweep:
    """Return the swaths for a track spacing and a turn, laid out once."""
    return CornerSweep(spacing_m, turn_rad)


@dataclass(frozen=True, slots=True)
class SweepAt:
    """The swaths about a corner in the frame of a slot whose track passes it at ``corner_x_m``.

    ``turn_rad``: the size of its turn [rad].
    """

    spacing_m: float
    corner_x_m: float
    turn_rad: float = 0.5 * math.pi

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area [m^2] that every path leaves uncovered, shape (n,).

        What was seen before the paths begin is not known here: it counts alike for all of them.
        """
        start = batch.start._replace(x_m=batch.start.x_m - self.corner_x_m)
        moved = PathBatch(start, batch.radius_m, batch.rows)
        return sweep_of(self.spacing_m, self.turn_rad).uncovered_m2(moved)
