"""What came of every seed, kept in a file, so that a long command can be broken off and resumed."""

from __future__ import annotations

import hashlib
import importlib
import json
import typing
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

T = TypeVar("T")
PACKAGES = ("sar_bridge", "sar_estimator", "sar_planner", "sar_sim")


def build_digest() -> str:
    """Return a digest of the project's modules as they are installed: results depend on them."""
    digest = hashlib.sha256()
    for name in PACKAGES:
        folder = Path(str(importlib.import_module(name).__file__)).parent
        for file in sorted(folder.rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


class ResultCache:
    """Results by part and seed, one JSON line each behind a line that says what they are of.

    A last line that was cut off, by a power failure say, is dropped. Raises ``ValueError`` for a
    file that holds the results of something else, or of another build.
    """

    def __init__(self, file: Path | None, about: Mapping[str, Any]) -> None:
        """Read what ``file`` holds; with None nothing is kept."""
        self._file = file
        self._rows: dict[tuple[str, int], dict[str, Any]] = {}
        if file is None:
            return
        head = json.loads(json.dumps({**about, "build": build_digest()}))
        if not file.exists():
            self._append(head)
            return
        text = file.read_text(encoding="utf-8")
        first, *lines = text.splitlines() or [""]
        try:
            found = json.loads(first)
        except json.JSONDecodeError:
            raise ValueError(f"{file}: expected a file of kept results") from None
        wrong = [key for key in head if not isinstance(found, dict) or found.get(key) != head[key]]
        if wrong:
            raise ValueError(f"{file}: of another {wrong[0]}; expected the same, or no file")
        if not text.endswith("\n"):
            lines = lines[:-1]
            file.write_text("".join(f"{line}\n" for line in (first, *lines)), encoding="utf-8")
        for line in lines:
            row = json.loads(line)
            self._rows[row["part"], row["seed"]] = row["result"]

    def get(self, part: str, seed: int, kind: type[T]) -> T | None:
        """Return a result that was kept, a dataclass of ``kind``; None where there is none."""
        row = self._rows.get((part, seed))
        if row is None:
            return None
        hints = typing.get_type_hints(kind)
        values = {}
        for key, value in row.items():
            made = typing.get_origin(hints[key])
            values[key] = made(value) if made in (tuple, frozenset) else value
        return kind(**values)

    def add(self, part: str, seed: int, result: Any) -> None:
        """Keep a dataclass of plain values; infinite numbers and NaN included."""
        if self._file is None:
            return
        row = {
            key: sorted(value) if isinstance(value, frozenset) else value
            for key, value in asdict(result).items()
        }
        self._append({"part": part, "seed": seed, "result": row})

    def _append(self, line: Mapping[str, Any]) -> None:
        assert self._file is not None
        with self._file.open("a", encoding="utf-8") as out:
            out.write(json.dumps(line) + "\n")
