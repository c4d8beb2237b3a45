import csv
import math
import os
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sar_estimator.cli.filter_track import COLUMNS, main
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.track_csv import read_track

REAL = Path(
    os.environ.get("SAR_TEST_DATA", Path(__file__).parents[4] / "shared" / "data"),
    "helicopter",
    "samu31_toulouse_1hz.csv",
)


def write(path, rows, header="time_s,latitude_deg,longitude_deg"):
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def read(path):
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return {
        name: np.array([float(r[name] or "nan") for r in rows])
        for name in COLUMNS
        if name != "phase"
    }


def test_straight_noisy_leg(tmp_path, capsys):
    rng = np.random.default_rng(1)
    datum = Datum(37.8, -122.8)
    noise = 3.0 * rng.standard_normal((400, 2))
    rows = []
    for t, (east, north) in enumerate(noise):
        latitude, longitude, _ = datum.to_geodetic(20.0 * t + east, north)
        rows.append(f"{t},{latitude:.9f},{longitude:.9f}")
    track, out = write(tmp_path / "t.csv", rows), tmp_path / "e.csv"
    assert main([str(track), "--out", str(out), "--datum", "37.8", "-122.8"]) == 0
    assert "400 accepted" in capsys.readouterr().out
    found = read(out)
    assert len(found["x_m"]) == 400
    position = np.hypot(found["x_m"] - 20.0 * np.arange(400), found["y_m"])[20:]
    assert np.sqrt(np.mean(position**2)) < 0.7 * np.sqrt(np.mean((noise[20:] ** 2).sum(axis=1)))
    ahead = np.hypot(
        found["next_x_m"][:-1] - found["x_m"][1:], found["next_y_m"][:-1] - found["y_m"][1:]
    )
    assert np.median(ahead[20:]) < 2.0


def test_every_row_has_an_output_row(tmp_path):
    rows = [
        "0,37.8,-122.8",
        ",37.8,-122.8",
        "1,,",
        "2,95.0,10.0",
        "2,37.8,-122.7999",
        "1.5,37.8,-122.8",
    ]
    out = tmp_path / "e.csv"
    assert main([str(write(tmp_path / "t.csv", rows)), "--out", str(out)]) == 0
    assert len(out.read_text(encoding="utf-8").splitlines()) == len(rows) + 1


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        ("time_s,latitude_deg", ["0,1"], "no column longitude_deg"),
        ("time_s,latitude_deg,longitude_deg", ["0,x,2"], "latitude_deg = 'x': expected a number"),
        ("time_s,latitude_deg,longitude_deg", [], "no rows"),
    ],
)
def test_bad_files_are_one_line(tmp_path, capsys, header, rows, message):
    track = write(tmp_path / "t.csv", rows, header)
    assert main([str(track), "--out", str(tmp_path / "e.csv")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_velocities_of_a_track_are_used_where_it_has_them(tmp_path, capsys):
    """A turn of 10 deg/s begins at 40 s; positions alone show it later."""
    datum = Datum(37.8, -122.8)
    rows, at, turned = [], np.zeros(2), []
    for t in range(60):
        course = math.radians(90.0 + (0.0 if t < 40 else 10.0 * (t - 40)))
        turned.append(course)
        latitude, longitude, _ = datum.to_geodetic(*at)
        known = f"40.0,{math.degrees(course)}" if t != 5 else ","
        rows.append(f"{t},{latitude:.9f},{longitude:.9f},{known}")
        at = at + 40.0 * np.array((math.sin(course), math.cos(course)))
    header = "time_s,latitude_deg,longitude_deg,groundspeed_mps,track_deg"
    track = write(tmp_path / "t.csv", rows, header)
    courses = {}
    for sigma in ("1.0", "inf"):
        out = tmp_path / f"{sigma}.csv"
        assert main([str(track), "--out", str(out), "--velocity-sigma", sigma]) == 0
        found = read(out)
        courses[sigma] = np.arctan2(found["vx_mps"], found["vy_mps"])[44:50] - turned[44:50]
    assert np.abs(courses["1.0"]).max() < 0.5 * np.abs(courses["inf"]).max()
    with pytest.raises(SystemExit, match="2"):
        main([str(track), "--out", str(out), "--velocity-sigma", "0"])
    assert "--velocity-sigma: 0: expected a positive number" in capsys.readouterr().err


def test_missing_file(tmp_path, capsys):
    assert main([str(tmp_path / "none.csv"), "--out", str(tmp_path / "e.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err


@pytest.mark.skipif(not REAL.exists(), reason=f"{REAL.name}: recorded track not here")
@pytest.mark.parametrize(
    ("options", "most"),
    [
        ([], 0.5),
        (["--sigma", "10"], 0.5),
        (["--velocity-sigma", "inf"], 0.65),
        (["--velocity-sigma", "inf", "--sigma", "10"], 0.65),
    ],
    ids=["default", "sigma 10", "positions only", "positions only, sigma 10"],
)
def test_real_helicopter_with_repeated_fixes(tmp_path, options, most):
    """``most``: of the next position's error, 90 %, over that of going on as since the last one."""
    out = tmp_path / "e.csv"
    assert main([str(REAL), "--out", str(out), *options]) == 0
    found = read(out)
    fixes = read_track(REAL)
    assert len(found["x_m"]) == len(fixes) == 378
    repeated = np.array(
        [False]
        + [
            (a.latitude_deg, a.longitude_deg) == (b.latitude_deg, b.longitude_deg)
            for a, b in pairwise(fixes)
        ]
    )
    assert repeated.sum() == 100
    assert all(np.isfinite(values).all() for values in found.values())
    step = np.hypot(np.diff(found["x_m"]), np.diff(found["y_m"]))
    speed = np.hypot(found["vx_mps"], found["vy_mps"])[1:]
    assert np.abs(step - speed)[repeated[1:]].max() < 3.0
    datum = Datum(fixes[0].latitude_deg, fixes[0].longitude_deg)
    measured = np.array([datum.to_local(f.latitude_deg, f.longitude_deg)[:2] for f in fixes])
    ahead = np.column_stack((found["next_x_m"], found["next_y_m"]))
    fresh = np.flatnonzero(~repeated)[11:]
    times = np.array([fix.time_s for fix in fixes])
    naive, error = [], []
    for before, last, now in zip(fresh, fresh[1:], fresh[2:], strict=False):
        velocity = (measured[last] - measured[before]) / (times[last] - times[before])
        expected = measured[last] + velocity * (times[now] - times[last])
        naive.append(math.dist(expected, measured[now]))
        error.append(math.dist(ahead[now - 1], measured[now]))
    assert np.percentile(error, 90) < most * np.percentile(naive, 90)
    assert np.median(error) < np.median(naive)
