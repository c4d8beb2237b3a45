"""Frozen dataclasses with other values of some fields, where they are made many times a second."""

from __future__ import annotations

from typing import TypeVar

Frozen = TypeVar("Frozen")


def replaced(one: Frozen, **changes: object) -> Frozen:
    """Return a frozen dataclass with other values of some fields, checked as a new one is.

    As ``dataclasses.replace``, which sets every field anew: this takes what stays as a whole, in a
    tenth of the time. For classes without slots, and without properties that are kept. Raises
    ``TypeError`` for a field that there is not.
    """
    kind = type(one)
    new = object.__new__(kind)
    values, fields = new.__dict__, one.__dict__
    values.update(fields)
    values.update(changes)
    if len(values) != len(fields):
        unknown = ", ".join(values.keys() - fields.keys())
        raise TypeError(f"{kind.__name__}: unknown field {unknown}")
    check = getattr(new, "__post_init__", None)
    if check is not None:
        check()
    return new
