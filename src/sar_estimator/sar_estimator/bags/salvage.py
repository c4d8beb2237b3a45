"""What can be read of a bag whose recorder was killed: everything up to the last whole record.

An MCAP file is a sequence of records, an operation code and a length each; what was written after
the last whole one is lost. See https://mcap.dev/spec.
"""

from __future__ import annotations

import os
import shutil
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from rosbags.interfaces import ConnectionExtRosbag2
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.typesys import Stores, get_typestore

MAGIC = b"\x89MCAP0\r\n"
DATA_END = 0x0F
HEAD = struct.Struct("<BQ")
TAIL = (
    HEAD.pack(DATA_END, 4) + struct.pack("<I", 0) + HEAD.pack(0x02, 20) + bytes(20) + MAGIC
)  # fmt: skip
METADATA = "metadata.yaml"


def whole_bytes(stream: BinaryIO, size: int) -> int:
    """Return how many bytes of a file of ``size`` are whole data records, from its beginning.

    Raises ``ValueError`` for a file that is no MCAP.
    """
    if stream.read(len(MAGIC)) != MAGIC:
        raise ValueError("not an MCAP file")
    at = len(MAGIC)
    while at + HEAD.size <= size:
        stream.seek(at)
        code, length = HEAD.unpack(stream.read(HEAD.size))
        end = at + HEAD.size + length
        if code in (0x00, DATA_END) or end > size:
            break
        at = end
    return at


def is_cut(folder: Path) -> bool:
    """Whether a bag folder holds an MCAP file that its recorder did not finish."""
    files = sorted(folder.glob("*.mcap")) if folder.is_dir() else []
    if not files:
        return False
    with files[0].open("rb") as stream:
        stream.seek(max(0, files[0].stat().st_size - len(MAGIC)))
        return stream.read() != MAGIC or not (folder / METADATA).exists()


@contextmanager
def salvaged(folder: Path) -> Iterator[Path]:
    """Give a whole bag with everything that is in a cut one, for as long as it is needed.

    Raises ``ValueError`` naming the folder when nothing can be read.
    """
    with tempfile.TemporaryDirectory() as scratch:
        file = min(folder.glob("*.mcap"))
        mended = Path(scratch, "mended.mcap")
        shutil.copyfile(file, mended)
        with mended.open("r+b") as stream:
            try:
                stream.truncate(whole_bytes(stream, file.stat().st_size))
            except ValueError as error:
                raise ValueError(f"{file}: {error}") from error
            stream.seek(0, os.SEEK_END)
            stream.write(TAIL)
        whole = Path(scratch, "bag")
        _copy(mended, whole)
        yield whole


def _copy(mended: Path, whole: Path) -> None:
    """Write the messages of an MCAP file without an index into a new bag."""
    typestore = get_typestore(Stores.ROS2_JAZZY)
    reader = McapReader(mended)
    reader.open()
    try:
        with Writer(whole, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connections = {}
            for item in reader.connections:
                assert isinstance(item.ext, ConnectionExtRosbag2)
                connections[item.id] = writer.add_connection(
                    item.topic,
                    item.msgtype,
                    typestore=typestore,
                    offered_qos_profiles=item.ext.offered_qos_profiles,
                )
            for connection, timestamp, data in reader.messages_scan(reader.connections):
                writer.write(connections[connection.id], timestamp, data)
    finally:
        reader.close()
