import pytest

from sar_estimator.bags.message_types import get_message
from sar_sim.bags.import_track import main
from sar_sim.bags.tracks import load_track


def test_csv_to_bag_and_back(tmp_path, capsys):
    track = tmp_path / "t.csv"
    track.write_text(
        "time_s,latitude_deg,longitude_deg,altitude_m\n"
        "1558092195.5,43.6,1.4,342.9\n,43.6,1.4,\n1558092196.5,43.7,1.5,300\n"
    )
    assert main([str(track), str(tmp_path / "bag")]) == 0
    assert "2 fixes" in capsys.readouterr().out
    fixes = load_track(tmp_path / "bag")
    assert [(f.time_s, f.latitude_deg, f.altitude_m) for f in fixes] == [
        (1558092195.5, 43.6, 342.9),
        (1558092196.5, 43.7, 300.0),
    ]
    assert fixes[0].covariance_m2 is None
    assert main([str(track), str(tmp_path / "bag")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_no_bag_is_one_line(tmp_path):
    with pytest.raises(ValueError, match="not a bag"):
        load_track(tmp_path)


def test_message_types_by_name():
    assert get_message("std_msgs/msg/String").__name__ == "String"
    for bad in ("std_msgs/String", "nowhere/msg/X", "std_msgs/msg/Nothing"):
        with pytest.raises(ValueError, match="not installed here"):
            get_message(bad)
