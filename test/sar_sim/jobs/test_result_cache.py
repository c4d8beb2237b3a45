"""Results that are kept: broken off, resumed, and not mixed with others."""

import json
import math
import os
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest

from sar_sim.jobs.pool import Workers, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.trials.encounters import Encounter, fly_encounter
from sar_sim.trials.rejoin_trials_cli import main as rejoin_trials


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


def all_of(file, seeds, log, part="x", scheduler=""):
    do = partial(work, log=log)
    # Work of a test module is not to be had in new interpreters: threads do it, or Dask's pickles.
    with Workers(2, scheduler) if scheduler else ThreadPoolExecutor(2) as workers:
        kept = ResultCache(file, {"work": "a"})
        return in_parallel(do, seeds, workers, kind=Result, kept=kept, part=part)


def test_what_is_kept_is_not_done_again_and_comes_back_equal(tmp_path):
    file, log = tmp_path / "kept.jsonl", tmp_path / "log"
    first = all_of(file, range(3), log)
    again = all_of(file, range(1, 5), log)
    assert flown(log) == [0, 1, 2, 3, 4]
    assert again[:2] == first[1:]
    assert [result.seed for result in again] == [1, 2, 3, 4]
    all_of(file, range(1), log, part="y")
    assert flown(log).count(0) == 2


def test_cut_off_at_any_byte_of_the_last_line_it_goes_on(tmp_path):
    file = tmp_path / "kept.jsonl"
    kept = ResultCache(file, {"work": "a"})
    results = [work(seed, tmp_path / "log") for seed in range(2)]
    for result in results:
        kept.add("", result.seed, result)
    whole = file.read_bytes()
    last = whole.rstrip(b"\n").rfind(b"\n") + 1
    for end in range(last, len(whole)):
        file.write_bytes(whole[:end])
        kept = ResultCache(file, {"work": "a"})
        assert kept.get("", 0, Result) == results[0]
        assert kept.get("", 1, Result) is None
        kept.add("", 1, results[1])
        assert file.read_bytes() == whole


def test_results_of_something_else_are_refused(tmp_path):
    file = tmp_path / "kept.jsonl"
    ResultCache(file, {"work": "a", "rules": "paper"})
    with pytest.raises(ValueError, match=r"kept\.jsonl: of another rules"):
        ResultCache(file, {"work": "a", "rules": "deadbeat"})
    file.write_text(file.read_text().replace('"build": "', '"build": "0'))
    with pytest.raises(ValueError, match="of another build"):
        ResultCache(file, {"work": "a", "rules": "paper"})
    file.write_text("seed;lag\n")
    with pytest.raises(ValueError, match="expected a file of kept results"):
        ResultCache(file, {"work": "a"})


def test_a_command_says_so_in_one_line(tmp_path, capsys):
    file = tmp_path / "kept.jsonl"
    file.write_text("[]\n")
    assert rejoin_trials(["--keep", str(file), "--starts", "1"]) == 2
    assert capsys.readouterr().err == (
        f"rejoin_trials: {file}: of another work; expected the same, or no file\n"
    )


def test_nothing_is_kept_without_a_file():
    kept = ResultCache(None, {})
    kept.add("", 1, work(1, log=Path(os.devnull)))
    assert kept.get("", 1, Result) is None


@pytest.mark.timeout(60)
def test_a_cluster_that_loses_a_worker_loses_and_doubles_no_row(tmp_path):
    """A scheduler and two workers in processes of their own; one is killed on the way."""
    file, seeds = tmp_path / "kept.jsonl", range(8)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        url = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    begin = partial(
        subprocess.Popen, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", url, "--no-dashboard"]
    processes = [begin([*scheduler, "--host", "127.0.0.1", "--port", url.rsplit(":", 1)[1]])]
    processes += [begin([*worker, "--nthreads", "1", "--no-nanny"]) for _ in range(2)]
    killer = threading.Thread(target=kill_when, args=(processes[1], file, 2), daemon=True)
    killer.start()
    try:
        made = on_cluster(url, file, seeds)
        killer.join(10.0)
        assert processes[1].poll() is not None
    finally:
        for process in processes:
            process.kill()
            process.wait(10.0)
    rows = [json.loads(line)["seed"] for line in file.read_text().splitlines()[1:]]
    assert rows == list(seeds)
    assert made == [fly_encounter(seed) for seed in seeds]


def on_cluster(url, file, seeds):
    """Fly on the cluster, as soon as its scheduler is there."""
    while True:
        with suppress(ValueError), Workers(None, url) as workers:
            kept = ResultCache(file, {"work": "a"})
            return in_parallel(fly_encounter, seeds, workers, kind=Encounter, kept=kept)


def kill_when(process, file, count):
    while not file.exists() or len(file.read_text().splitlines()) <= count:
        time.sleep(0.02)
    process.kill()
