"""What a campaign came to: a row a mission, and a row a combination with 95 % intervals."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from sar_planner.paths.flight_path import FloatArray
from sar_sim.campaign.campaign import Campaign, Combination
from sar_sim.campaign.missions import Mission, watched

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A mean, or a share, and its 95 % interval; NaN where nothing can be said."""

    value: float
    low: float = math.nan
    high: float = math.nan

    def text(self, digits: int) -> str:
        """Return it as ``value (low to high)``, or ``-``."""
        if math.isnan(self.value):
            return "-"
        if math.isnan(self.low):
            return f"{self.value:.{digits}f}"
        return f"{self.value:.{digits}f} ({self.low:.{digits}f} to {self.high:.{digits}f})"


def mean_of(values: Sequence[float]) -> Estimate:
    """Return the mean of what is a number, with Student's interval."""
    sample = np.array([value for value in values if math.isfinite(value)])
    if sample.size == 0:
        return Estimate(math.nan)
    mean = float(sample.mean())
    if sample.size == 1:
        return Estimate(mean)
    spread = float(sample.std(ddof=1)) / math.sqrt(sample.size)
    half = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, sample.size - 1)) * spread
    return Estimate(mean, mean - half, mean + half)


def share_of(hits: Sequence[bool]) -> Estimate:
    """Return a share [%] with Wilson's interval."""
    if not hits:
        return Estimate(math.nan)
    found = stats.binomtest(sum(hits), len(hits)).proportion_ci(CONFIDENCE, method="wilson")
    share = sum(hits) / len(hits)
    return Estimate(100.0 * share, 100.0 * float(found.low), 100.0 * float(found.high))


def corners_to_converge(lags_m: Sequence[float], tolerance_m: float) -> float:
    """Return after how many corners |L(k)| stays within a tolerance [m]; NaN where it does not."""
    late = [k for k, lag in enumerate(lags_m) if abs(lag) > tolerance_m]
    first = late[-1] + 1 if late else 0
    return float(first) if first < len(lags_m) else math.nan


def spread_of(values_m: FloatArray) -> str:
    """Return the mean, and within what 90 % are [m]."""
    low, high = np.percentile(values_m, (5.0, 95.0))
    return f"{values_m.mean():.0f} ({low:.0f} to {high:.0f})"


@dataclass(frozen=True)
class Summary:
    """One combination: |L(k)| from a corner on, and the rest over its missions."""

    combination: Combination
    missions: tuple[Mission, ...]

    @property
    def late_m(self) -> np.ndarray:
        """All UAVs' |L(k)| from the corner on that counts [m], ends of cross legs left out."""
        return self._late_m(cross_legs=False)

    @property
    def crossing_m(self) -> np.ndarray:
        """The same at the ends of cross legs, where a U-turn is under way [m]."""
        return self._late_m(cross_legs=True)

    def _late_m(self, *, cross_legs: bool) -> np.ndarray:
        terms = self.combination.scenario.pattern.terms
        lags = [
            abs(lag)
            for mission in self.missions
            for of_uav in (mission.lags_m, *mission.others_lags_m)
            for leg, lag in enumerate(of_uav)
            if leg >= self.combination.from_corner - 1 and terms.is_cross_leg(leg) is cross_legs
        ]
        return np.array(lags or [math.nan])

    def extra_by_rule_m(self) -> dict[str, FloatArray]:
        """Return how much farther than planned was flown at the corners of every rule [m]."""
        found: dict[str, list[float]] = {}
        for mission in self.missions:
            for rule, extra in zip(mission.rules, mission.extra_m, strict=False):
                if math.isfinite(extra):
                    found.setdefault(rule, []).append(extra)
        return {rule: np.array(extras) for rule, extras in sorted(found.items())}

    def values(self) -> dict[str, Estimate]:
        """Return every figure by name, with its unit."""
        missions, late, tolerance_m = self.missions, self.late_m, self.combination.tolerance_m
        corners = [corners_to_converge(m.lags_m, tolerance_m) for m in missions]
        apart = [m.separation_m for m in missions]
        extra = [float(np.nanmean(m.extra_m)) for m in missions if np.isfinite(m.extra_m).any()]
        return {
            "late_lag_median_m": Estimate(float(np.median(late))),
            "late_lag_p95_m": Estimate(float(np.percentile(late, 95))),
            "late_lag_max_m": Estimate(float(late.max())),
            "late_corners_within_percent": share_of((late <= tolerance_m).tolist()),
            "converged_percent": share_of([math.isfinite(count) for count in corners]),
            "corners_to_converge": mean_of(corners),
            "extra_path_m": mean_of(extra),
            "separation_least_m": Estimate(min(apart)),
            "separation_m": mean_of(apart),
            "uavs_apart_m": Estimate(min(m.uavs_apart_m for m in missions)),
            "crossing_lag_p95_m": Estimate(float(np.percentile(self.crossing_m, 95))),
            "coverage_percent": mean_of([m.coverage_percent for m in missions]),
            "reached_percent": mean_of([m.reached_percent for m in missions]),
            "overlap_percent": mean_of([m.overlap_percent for m in missions]),
            "rate_km2_per_h": mean_of([m.rate_km2_per_h for m in missions]),
            "alone_km2_per_h": mean_of([m.alone_km2_per_h for m in missions]),
            "lists_per_corner": mean_of([m.lists / max(1, len(m.lags_m)) for m in missions]),
            "escapes": Estimate(float(sum(m.alerts["escape"] for m in missions))),
        }


def summaries(campaign: Campaign, missions: Sequence[Sequence[Mission]]) -> list[Summary]:
    """Return a campaign's summaries, of the missions of each combination."""
    return [
        Summary(one, tuple(flown))
        for one, flown in zip(campaign.combinations, missions, strict=True)
    ]


def write_rows(path: Path, campaign: Campaign, missions: Sequence[Sequence[Mission]]) -> None:
    """Write a row a mission: what varied, the seed, and all that came of it."""
    factors = list(campaign.combinations[0].labels)
    with path.open("w", encoding="utf-8", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["campaign", *factors, *_row_of(missions[0][0])])
        for one, flown in zip(campaign.combinations, missions, strict=True):
            for mission in flown:
                row = _row_of(mission)
                table.writerow([campaign.name, *one.labels.values(), *row.values()])


def _row_of(mission: Mission) -> dict[str, object]:
    return {
        "seed": mission.seed,
        "lag_m": _list(mission.lags_m),
        "extra_path_m": _list(mission.extra_m),
        "corner_rules": " ".join(mission.rules),
        "separation_m": mission.separation_m,
        "separation_s": mission.separation_s,
        "others_lags_m": "; ".join(_list(lags) for lags in mission.others_lags_m),
        "uavs_apart_m": mission.uavs_apart_m,
        "coverage_percent": mission.coverage_percent,
        "reached_percent": mission.reached_percent,
        "overlap_percent": mission.overlap_percent,
        "seen_km2": mission.seen_km2,
        "rate_km2_per_h": mission.rate_km2_per_h,
        "corrections": mission.corrections,
        "lists": mission.lists,
        "false_corners": mission.false_corners,
        "flown_s": mission.flown_s,
        **{f"monitor_{name}": count for name, count in mission.alerts.items()},
        "said": "; ".join(sorted(mission.problems)),
    }


def _list(values: Sequence[float]) -> str:
    return " ".join(f"{value:.3f}" for value in values)


def write_summary(path: Path, found: Sequence[Summary]) -> None:
    """Write a row a combination: every figure with the ends of its interval."""
    with path.open("w", encoding="utf-8", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        factors = list(found[0].combination.labels)
        names = [f"{name}{end}" for name in found[0].values() for end in ("", "_low", "_high")]
        table.writerow([*factors, "missions", *names])
        for one in found:
            ends = [end for v in one.values().values() for end in (v.value, v.low, v.high)]
            labels = one.combination.labels.values()
            table.writerow([*labels, len(one.missions), *(f"{end:.6g}" for end in ends)])


HEADER = (
    f"{'':34s}{'|L(k)|, late corners [m]':>26s}{'within':>8s}{'apart [m]':>18s}"
    f"{'coverage [%]':>24s}{'km2/h':>7s}\n"
    f"{'':34s}{'median':>10s}{'p95':>8s}{'max':>8s}{'[%]':>8s}{'least':>9s}{'mean':>9s}"
    f"{'mean (95 %)':>24s}{'mean':>7s}"
)


def line_of(one: Summary) -> str:
    """Return a combination's line of the table, and what was said and done."""
    v = one.values()
    within, good = v["late_corners_within_percent"].value, v["converged_percent"]
    said = sorted({problem for mission in one.missions for problem in mission.problems})
    extra, corners = v["extra_path_m"], v["corners_to_converge"]
    by_rule = [f"{rule} {spread_of(extras)}" for rule, extras in one.extra_by_rule_m().items()]
    apart_m, crossing_m = v["uavs_apart_m"].value, v["crossing_lag_p95_m"].value
    beside = f"; the helicopter alone {v['alone_km2_per_h'].value:.2f} km2/h"
    beside += f"; UAVs in one layer {apart_m:.1f} m apart" if math.isfinite(apart_m) else ""
    if math.isfinite(crossing_m):
        beside += f"; |L| at ends of cross legs, p95 {crossing_m:.1f} m"
    return (
        f"{one.combination.name:34s}{v['late_lag_median_m'].value:10.1f}"
        f"{v['late_lag_p95_m'].value:8.1f}{v['late_lag_max_m'].value:8.1f}{within:8.1f}"
        f"{v['separation_least_m'].value:9.1f}{v['separation_m'].value:9.1f}"
        f"{v['coverage_percent'].text(2):>24s}{v['rate_km2_per_h'].value:7.2f}\n"
        f"    |L(k)| from corner {one.combination.from_corner} on; "
        f"within {one.combination.tolerance_m:g} m for good: {good.text(1)} % of missions, "
        f"after {corners.text(1)} corners; extra path {extra.text(1)} m a corner\n"
        f"    coverage of what the helicopter's own track allows {v['reached_percent'].text(2)} %; "
        f"{v['lists_per_corner'].text(1)} lists a corner{beside}\n"
        f"    extra path by rule, mean and 90 % of them [m]: {', '.join(by_rule) or '-'}\n"
        f"    {watched(one.missions)}" + (f"; said: {'; '.join(said)}" if said else "")
    )
