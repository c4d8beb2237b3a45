"""Tracks are read whole, or refused with file, line and column."""

import math

import pytest

from sar_estimator.common.track_csv import read_track, read_velocities

HEAD = "time_s,latitude_deg,longitude_deg"


def track(tmp_path, text):
    path = tmp_path / "track.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_row_is_a_fix_and_an_empty_cell_no_number(tmp_path):
    first, second = read_track(
        track(tmp_path, f"{HEAD},altitude_m\n1,37.5,-122.5,30\n2,,-122.4,\n")
    )
    assert (first.time_s, first.latitude_deg, first.altitude_m) == (1.0, 37.5, 30.0)
    assert math.isnan(second.latitude_deg)
    assert second.altitude_m == 0.0


def test_velocities_are_east_and_north_of_a_compass_course(tmp_path):
    path = track(tmp_path, f"{HEAD},groundspeed_mps,track_deg\n1,0,0,10,90\n2,0,0,10,0\n3,0,0,,\n")
    east, north, none = read_velocities(path)
    assert east == pytest.approx((10.0, 0.0), abs=1e-9)
    assert north == pytest.approx((0.0, 10.0), abs=1e-9)
    assert all(map(math.isnan, none))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,latitude_deg\n1,2\n", "no column longitude_deg: expected time_s, latitude_deg, l"),
        (f"{HEAD}\n", "no rows: expected at least one fix"),
        ("", "no column time_s"),
        (f"{HEAD}\n1,2,3\n4,north,6\n", ":3: latitude_deg = 'north': expected a number"),
    ],
)
def test_what_is_no_track_is_told_with_its_place(tmp_path, text, message):
    with pytest.raises(ValueError, match="expected") as error:
        read_track(track(tmp_path, text))
    assert str(error.value).startswith(str(tmp_path / "track.csv"))
    assert message in str(error.value)
    assert "\n" not in str(error.value)
