from sar_sim.detection_cli import delay_s, main
from sar_sim.scenario import Gps


def test_delay_counts_from_the_true_onset():
    assert 0.9 < delay_s(Gps(sigma_m=0.0, seed=3), 20.0, 2.5) < 3.0


def test_study_prints_its_table(capsys):
    assert main(["--seeds", "8", "--hours", "0.1", "--doppler", "0.1"]) == 0
    out = capsys.readouterr().out
    assert "not seen 0, too early 0" in out
    assert "0.1 h of straight flight: 0 false alarms" in out
