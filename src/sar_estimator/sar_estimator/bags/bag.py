"""Bags: standard rosbag2 MCAP, written and read with rosbags."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from backports import zstd
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import (
    CompressionFormat,
    CompressionMode,
    ReaderError,
    StoragePlugin,
    Writer,
    WriterError,
)
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from sar_estimator.bags.former import as_now
from sar_estimator.bags.salvage import is_cut, salvaged

# What reading a damaged bag may raise: rosbags believes the lengths and types it reads.
BAG_ERRORS = (
    AnyReaderError,
    ReaderError,
    WriterError,
    SerdeError,
    OSError,
    ValueError,
    LookupError,
    AssertionError,
    MemoryError,
    ArithmeticError,
    TypeError,
    EOFError,
    struct.error,
    zstd.ZstdError,
)
TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
UNLIMITED = QosTime(sec=9223372036, nsec=854775807)


def _qos(*, latched: bool) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        1 if latched else 10,
        QosReliability.RELIABLE,
        QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        UNLIMITED,
        UNLIMITED,
        QosLiveliness.AUTOMATIC,
        UNLIMITED,
        avoid_ros_namespace_conventions=False,
    )


class BagWriter:
    """Writes serialised messages to a new bag folder."""

    def __init__(self, folder: Path) -> None:
        """Create the bag. Raises ``WriterError`` when the folder is there already.

        Its chunks are compressed, a fifth of the size: a day's flights fit on a laptop.
        """
        self.folder = folder
        self._writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._writer.open()
        self._connections: dict[str, Connection] = {}
        self._syncer = ThreadPoolExecutor(1)
        self._synced: Future[None] | None = None
        self.messages = 0

    def add_topic(self, topic: str, kind: str, *, latched: bool = False) -> None:
        """Announce a topic, once; it takes a while, so do it before its messages come fast."""
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=TYPESTORE, offered_qos_profiles=[_qos(latched=latched)]
            )

    def write(
        self, topic: str, kind: str, data: bytes, time_s: float, *, latched: bool = False
    ) -> None:
        """Append a message of type ``kind`` (``pkg/msg/Name``) at ``time_s`` [s]."""
        self.add_topic(topic, kind, latched=latched)
        self._writer.write(self._connections[topic], round(time_s * 1e9), data)
        self.messages += 1

    def flush(self) -> None:
        """Hand everything written so far to the system, where a kill does not take it away.

        It is on the disk, where a power cut does not either, as soon as that has taken it: a slow
        one is not waited for. Raises ``OSError`` when it did not take what was flushed before.
        """
        storage = self._writer.storage
        if not isinstance(storage, McapWriter):
            return
        if storage.chunk.bio.tell():
            storage.close_chunk()
        storage.bio.flush()
        if self._synced is not None and not self._synced.done():
            return
        if self._synced is not None:
            self._synced.result()
        self._synced = self._syncer.submit(os.fsync, storage.bio.fileno())

    def close(self) -> None:
        """Finish the bag."""
        self._syncer.shutdown()
        self._writer.close()


def serialised(kind: str, message: Any) -> bytes:
    """Return a message of rclpy's as bytes, as rosbags writes it."""
    if kind == "diagnostic_msgs/msg/DiagnosticArray":
        message = TYPESTORE.types[kind](
            header=message.header, status=[_with_number(status) for status in message.status]
        )
    elif kind == "diagnostic_msgs/msg/DiagnosticStatus":
        message = _with_number(message)
    return bytes(TYPESTORE.serialize_cdr(message, kind))


def _with_number(status: Any) -> Any:
    """Return a status as rosbags has it: its level, an octet, is bytes in rclpy, a number there."""
    return TYPESTORE.types["diagnostic_msgs/msg/DiagnosticStatus"](
        level=status.level[0],
        name=status.name,
        message=status.message,
        hardware_id=status.hardware_id,
        values=status.values,
    )


def known_type(kind: str) -> bool:
    """Whether a message type can be recorded."""
    return kind in TYPESTORE.types


@contextmanager
def open_bag(path: Path) -> Iterator[AnyReader]:
    """Give a reader of a bag folder; of one that was cut, up to its last whole record."""
    with ExitStack() as stack:
        whole = stack.enter_context(salvaged(path)) if is_cut(path) else path
        yield stack.enter_context(AnyReader([whole], default_typestore=TYPESTORE))


def topics_in(path: Path) -> set[str]:
    """Return the topics that a bag has."""
    with open_bag(path) as reader:
        return {connection.topic for connection in reader.connections}


def read_messages(path: Path, topics: set[str] | None = None) -> Iterator[tuple[str, float, Any]]:
    """Yield (topic, time [s], message) in the order of the bag, of all or the named topics.

    What carried JSON once is given as it is now.
    """
    with open_bag(path) as reader:
        chosen = [c for c in reader.connections if topics is None or c.topic in topics]
        if not chosen:
            return
        for connection, timestamp, raw in reader.messages(connections=chosen):
            kind = connection.msgtype
            message = reader.deserialize(raw, kind)
            for topic, one in as_now(connection.topic, kind, message):
                yield topic, timestamp * 1e-9, one
