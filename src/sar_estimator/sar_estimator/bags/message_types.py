"""ROS message classes by name."""

from __future__ import annotations

import importlib
from typing import Any


def get_message(kind: str) -> Any:
    """Return the class of ``pkg/msg/Name``. Raises ``ValueError`` when there is none."""
    try:
        package, group, name = kind.split("/")
        return getattr(importlib.import_module(f"{package}.{group}"), name)
    except (ValueError, ImportError, AttributeError) as error:
        raise ValueError(f"message type {kind}: not installed here") from error
