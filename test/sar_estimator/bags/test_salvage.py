"""Bags whose recorder was killed are read up to their last whole record."""

import errno
import json
import math
import os
import threading
from pathlib import Path

import pytest
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message

from sar_estimator.bags.bag import BagWriter, open_bag, read_messages
from sar_estimator.bags.salvage import is_cut
from sar_estimator.common.conversions import text_message

PERIOD_S, FLUSHED_EVERY, COUNT = 0.1, 10, 600


def write(folder, *, close=False):
    """Write a minute of messages, brought to the disk every second; return the writer.

    Beside the bag, in ``flushed``: the file's size after every flush.
    """
    bag, sizes = BagWriter(folder), []
    for i in range(COUNT):
        data = serialize_message(text_message(f"{i} " + 40 * "x"))
        bag.write(
            f"/t{i % 3}", "std_msgs/msg/String", data, 100.0 + PERIOD_S * i, latched=i % 3 == 0
        )
        if (i + 1) % FLUSHED_EVERY == 0:
            bag.flush()
            sizes.append((folder / f"{folder.name}.mcap").stat().st_size)
    (folder.parent / "flushed").write_text(json.dumps(sizes), encoding="utf-8")
    if close:
        bag.close()
    return bag


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Return the folder of a bag that was never finished, as a killed process leaves it."""
    folder = tmp_path_factory.mktemp("killed") / "bag"
    child = os.fork()
    if child == 0:
        write(folder)
        os._exit(9)
    os.waitpid(child, 0)
    return folder


def numbers(folder):
    return [int(message.data.split()[0]) for _, _, message in read_messages(folder)]


def test_a_finished_bag_is_read_as_it_is(tmp_path):
    write(tmp_path / "bag", close=True)
    assert not is_cut(tmp_path / "bag")
    assert sorted(numbers(tmp_path / "bag")) == list(range(COUNT))


def test_odometry_takes_less_than_half_its_size(tmp_path):
    bag, told = BagWriter(tmp_path / "bag"), 0
    for i in range(COUNT):
        message = Odometry(child_frame_id="uav")
        message.pose.pose.position = Point(x=23.7 * i, y=math.sin(i), z=150.0 + math.cos(i))
        data = serialize_message(message)
        told += len(data)
        bag.write("/uav/odometry", "nav_msgs/msg/Odometry", data, PERIOD_S * i)
        if (i + 1) % FLUSHED_EVERY == 0:
            bag.flush()
    bag.close()
    assert (tmp_path / "bag" / "bag.mcap").stat().st_size < 0.5 * told
    with open_bag(tmp_path / "bag") as reader:
        assert sum(len(data) for _, _, data in reader.messages()) == told


def test_a_killed_recorder_loses_nothing_that_was_flushed(killed):
    assert not (killed / "metadata.yaml").exists()
    assert is_cut(killed)
    assert sorted(numbers(killed)) == list(range(COUNT))
    with open_bag(killed) as reader:
        latched = {
            c.topic: c.ext.offered_qos_profiles[0].durability.name for c in reader.connections
        }
    assert latched["/t0"] == "TRANSIENT_LOCAL"
    assert latched["/t1"] == "VOLATILE"


@pytest.mark.parametrize("finished", [False, True])
def test_cut_at_any_byte_it_is_read_up_to_the_last_second(tmp_path, killed, finished):
    folder = killed
    if finished:
        write(tmp_path / "whole", close=True)
        folder = tmp_path / "whole"
    data = next(folder.glob("*.mcap")).read_bytes()
    flushed = json.loads((folder.parent / "flushed").read_text("utf-8"))
    counts = []
    for size in range(len(data) - 1, flushed[0], -611):
        cut = tmp_path / f"cut{size}"
        cut.mkdir()
        (cut / "cut.mcap").write_bytes(data[:size])
        try:
            found = sorted(numbers(cut))
        except ValueError:
            found = []
        assert found == list(range(len(found)))
        there = FLUSHED_EVERY * sum(end <= size for end in flushed)
        assert there <= len(found) <= there + FLUSHED_EVERY
        counts.append(len(found))
    assert counts == sorted(counts, reverse=True)
    assert len(counts) > 30


@pytest.mark.parametrize("content", [b"", b"\x89MC", b"something else altogether"])
def test_a_file_that_is_no_bag_is_one_line(tmp_path, content):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "bag.mcap").write_bytes(content)
    with pytest.raises(ValueError, match="not an MCAP file") as error:
        numbers(tmp_path / "bag")
    assert str(tmp_path) in str(error.value)
    assert Path(tmp_path, "bag", "bag.mcap").read_bytes() == content


def test_a_slow_disk_is_not_waited_for_and_its_error_is_told(tmp_path, monkeypatch):
    begun, go_on = threading.Event(), threading.Event()
    calls = []

    def fsync(number):
        calls.append(number)
        begun.set()
        assert go_on.wait(30.0)
        raise OSError(errno.EIO, "no disk")

    monkeypatch.setattr(os, "fsync", fsync)
    bag = BagWriter(tmp_path / "bag")
    for _ in range(3):
        bag.write("/t", "std_msgs/msg/String", serialize_message(text_message("x")), 1.0)
        bag.flush()
        assert begun.wait(30.0)
    assert len(calls) == 1
    go_on.set()
    assert bag._synced.exception(timeout=30.0) is not None
    with pytest.raises(OSError, match="no disk"):
        bag.flush()
    bag.close()
