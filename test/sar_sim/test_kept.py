"""Results that are kept: broken off, resumed, and not mixed with others."""

import math
import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest

from sar_sim.kept import Kept
from sar_sim.pool import in_parallel
from sar_sim.squares_cli import main as squares


@dataclass(frozen=True)
class Result:
    seed: int
    lags_m: tuple[float, ...]
    problems: frozenset[str]
    alerts: dict[str, int]


def work(seed, log):
    with log.open("a") as out:
        out.write(f"{seed}\n")
    return Result(seed, (0.1 * seed, math.inf), frozenset({"b", "a"}), {"escape": seed})


def flown(log):
    return sorted(int(line) for line in log.read_text().split()) if log.exists() else []


def test_what_is_kept_is_not_done_again_and_comes_back_equal(tmp_path):
    file, log = tmp_path / "kept.jsonl", tmp_path / "log"
    do = partial(work, log=log)
    first = in_parallel(do, range(3), 2, kind=Result, kept=Kept(file, {"work": "a"}), part="x")
    again = in_parallel(do, range(1, 5), 2, kind=Result, kept=Kept(file, {"work": "a"}), part="x")
    assert flown(log) == [0, 1, 2, 3, 4]
    assert again[:2] == first[1:]
    assert [result.seed for result in again] == [1, 2, 3, 4]
    in_parallel(do, range(1), 1, kind=Result, kept=Kept(file, {"work": "a"}), part="y")
    assert flown(log).count(0) == 2


def test_cut_off_at_any_byte_of_the_last_line_it_goes_on(tmp_path):
    file = tmp_path / "kept.jsonl"
    kept = Kept(file, {"work": "a"})
    results = [work(seed, tmp_path / "log") for seed in range(2)]
    for result in results:
        kept.add("", result.seed, result)
    whole = file.read_bytes()
    last = whole.rstrip(b"\n").rfind(b"\n") + 1
    for end in range(last, len(whole)):
        file.write_bytes(whole[:end])
        kept = Kept(file, {"work": "a"})
        assert kept.get("", 0, Result) == results[0]
        assert kept.get("", 1, Result) is None
        kept.add("", 1, results[1])
        assert file.read_bytes() == whole


def test_results_of_something_else_are_refused(tmp_path):
    file = tmp_path / "kept.jsonl"
    Kept(file, {"work": "a", "rules": "paper"})
    with pytest.raises(ValueError, match=r"kept\.jsonl: of another rules"):
        Kept(file, {"work": "a", "rules": "deadbeat"})
    file.write_text(file.read_text().replace('"build": "', '"build": "0'))
    with pytest.raises(ValueError, match="of another build"):
        Kept(file, {"work": "a", "rules": "paper"})
    file.write_text("seed;lag\n")
    with pytest.raises(ValueError, match="expected a file of kept results"):
        Kept(file, {"work": "a"})


def test_a_command_says_so_in_one_line(tmp_path, capsys):
    file = tmp_path / "kept.jsonl"
    file.write_text("[]\n")
    assert squares(["--keep", str(file), "--seeds", "1"]) == 2
    assert capsys.readouterr().err == (
        f"squares: --keep {file}: of another work; expected the same, or no file\n"
    )


def test_nothing_is_kept_without_a_file():
    kept = Kept(None, {})
    kept.add("", 1, work(1, log=Path(os.devnull)))
    assert kept.get("", 1, Result) is None
