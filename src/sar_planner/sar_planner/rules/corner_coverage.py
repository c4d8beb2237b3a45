"""How much of the UAV's two swaths about a corner a path leaves uncovered.

In the frame of the new slot track (x along it, the slot tracks cross at (d, 0)): the old swath
comes up along x = d, the new one leads away along y = 0, each d wide. A disc of d / 2 about the UAV
sees.
"""

from __future__ import annotations

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
    """Cells of both swaths about a corner, for one track spacing d [m]."""

    def __init__(self, spacing_m: float) -> None:
        """Lay the cells out; the square in which the swaths cross belongs to the old one."""
        d = self._d = spacing_m
        steps = np.arange(0.5 * CELL, REACH, CELL)
        lanes = np.array(LANES)
        old = np.array([(1.0 + lane, -step + 0.5) for step in steps for lane in lanes])
        # What neither the old track's end nor the new one's begin would see of the outer corner.
        beyond = (old[:, 1] > 0.0) & (np.hypot(old[:, 0] - 1.0, old[:, 1]) > 0.5)
        new = np.array([(1.5 + step, lane) for step in steps for lane in lanes])
        self._old, self._new = d * old[~beyond], d * new
        self._cell_m2 = CELL * LANE * d**2

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area [m^2] that every path leaves uncovered, shape (n,), to about a cell.

        Before its start the old track was flown, after its end the new one will be.
        """
        old = self._old[self._old[:, 1] > batch.start.y_m]
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


@lru_cache(maxsize=4)
def sweep_of(spacing_m: float) -> CornerSweep:
    """Return the swaths for a track spacing, laid out once."""
    return CornerSweep(spacing_m)


@dataclass(frozen=True, slots=True)
class SweepAt:
    """The swaths about a corner in the frame of a slot whose track passes it at ``corner_x_m``."""

    spacing_m: float
    corner_x_m: float

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area [m^2] that every path leaves uncovered, shape (n,).

        What was seen before the paths begin is not known here: it counts alike for all of them.
        """
        start = batch.start._replace(x_m=batch.start.x_m - self.corner_x_m)
        moved = PathBatch(start, batch.radius_m, batch.rows)
        return sweep_of(self.spacing_m).uncovered_m2(moved)
