"""Values that are checked as their types declare it, with errors of one line.

A dataclass of pydantic's says with each field what it may be: ``Positive``, ``Literal[...]``.
``read`` makes one of plain values, such as YAML gives. ``bounds_of`` tells the same bounds to ROS
and to the documentation.
"""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import asdict, fields
from functools import cache
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeVar,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

T = TypeVar("T")

CHECKED = ConfigDict(extra="forbid", allow_inf_nan=False)
"""How checked dataclasses are: no unknown keys, only finite numbers."""

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
PositiveRange = tuple[Positive, Positive]


def _side(value: object) -> object:
    return int(value) if value in ("1", "-1") else value


Side = Annotated[Literal[1, -1], BeforeValidator(_side)]
"""1 for patterns that turn right, -1 for those that turn left."""

Count = Annotated[int, Field(ge=1)]


def _word(value: object) -> object:
    """Return the words that YAML 1.1 takes for true and false."""
    return ("off", "on")[value] if isinstance(value, bool) else value


Word = Annotated[str, BeforeValidator(_word)]

WANTED = {
    "float": "a number",
    "finite": "a number",
    "int": "a whole number",
    "string": "a text",
    "bool": "true or false",
    "list": "a list",
    "tuple": "a list",
    "dict": "a mapping",
    "dataclass": "a mapping",
}
"""What was expected, by the first word of pydantic's type of an error."""


class Bounds(NamedTuple):
    """Between what a number may be; ``open_low``, ``open_high``: not the bound itself."""

    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    open_high: bool = False

    def __str__(self) -> str:
        """Return them in words, empty for none."""
        low = f"more than {self.low:g}" if self.open_low else f"{self.low:g} or more"
        high = f"less than {self.high:g}" if self.open_high else f"at most {self.high:g}"
        if math.isinf(self.high):
            return "" if math.isinf(self.low) else low
        if math.isinf(self.low):
            return high
        if self.open_low or self.open_high:
            return f"{low}, {high}"
        return f"{self.low:g} to {self.high:g}"


@cache
def _adapter(kind: Hashable) -> TypeAdapter[Any]:
    return TypeAdapter(cast("Any", kind))


def read(kind: type[T], values: object, where: str = "", *, texts: bool = False) -> T:
    """Return plain values as ``kind``. Raises ``ValueError``: key, value and what was expected.

    ``where``: what the keys are in. ``texts``: numbers may come as texts.
    """
    try:
        # Strictly, but lists for tuples and mappings for dataclasses: as JSON is taken.
        text = json.dumps(values, default=str)
        found: T = _adapter(cast("Hashable", kind)).validate_json(text, strict=not texts)
    except ValidationError as error:
        raise ValueError(_line(kind, _worst(error), where)) from error
    except (TypeError, ValueError) as error:
        raise ValueError(f"{where}: {error}: expected texts for keys") from error
    return found


def changed(value: T, **changes: object) -> T:
    """Return a checked dataclass with other values, checked as by ``read``."""
    return read(type(value), {**asdict(value), **changes})  # type: ignore[call-overload]


def bounds_of(kind: type[Any]) -> dict[str, Bounds]:
    """Return the bounds of a dataclass's numbers by name."""
    hints = get_type_hints(kind, include_extras=True)
    return {name: _bounds(annotation) for name, annotation in hints.items()}


def choices_of(kind: type[Any]) -> dict[str, tuple[Any, ...]]:
    """Return the values that a dataclass's fields may have, of those that have a choice."""
    hints = get_type_hints(kind, include_extras=True)
    bare = {name: _bare(annotation) for name, annotation in hints.items()}
    return {name: get_args(one) for name, one in bare.items() if get_origin(one) is Literal}


def _worst(error: ValidationError) -> Any:
    """Return what is told of all that is wrong: a key that is unknown, else the first thing."""
    found = error.errors()
    unknown = (one for one in found if one["type"] == "unexpected_keyword_argument")
    return next(unknown, found[0])


def _line(kind: Any, error: Any, where: str) -> str:
    """Return what is wrong in one line."""
    what, loc = error["type"], error["loc"]
    key = where
    for part in loc:
        key += f"[{part}]" if isinstance(part, int) else f".{part}" if key else str(part)
    if what == "missing":
        return f"{key}: missing"
    if what == "unexpected_keyword_argument":
        known = (item.name for item in fields(_bare(_at(kind, loc[:-1]))))
        return f"{key}: unknown key, expected one of {', '.join(known)}"
    if what == "value_error":
        return ".".join(filter(None, (key, str(error["ctx"]["error"]))))
    return f"{key or 'it'} = {error['input']!r}: expected {_expected(_at(kind, loc), error)}"


def _expected(annotation: Any, error: Any) -> str:
    if error["type"] == "literal_error":
        return str(error["ctx"]["expected"]).replace("'", "")
    wanted = WANTED.get(error["type"].partition("_")[0])
    return wanted or str(_bounds(annotation)) or str(error["msg"])


def _at(annotation: Any, loc: Sequence[int | str]) -> Any:
    """Return the annotation of what is at a place."""
    for part in loc:
        kind = _bare(annotation)
        if isinstance(part, int) or get_origin(kind) is dict:
            annotation = (get_args(kind) or (Any,))[-1 if isinstance(part, str) else 0]
        else:
            annotation = get_type_hints(kind, include_extras=True).get(part, Any)
    return annotation


def _bare(annotation: Any) -> Any:
    """Return a type without what else is said of it, and without its being optional."""
    args = get_args(annotation)
    if get_origin(annotation) is Annotated or type(None) in args:
        return _bare(next(one for one in args if one is not type(None)))
    return annotation


def _said(annotation: Any) -> Iterator[Any]:
    """Yield what is said of a type."""
    for one in getattr(annotation, "__metadata__", ()):
        yield from one.metadata if isinstance(one, FieldInfo) else (one,)
    if type(None) in get_args(annotation):
        for one in get_args(annotation):
            yield from _said(one)


def _bounds(annotation: Any) -> Bounds:
    found = Bounds()
    for one in _said(annotation):
        if hasattr(one, "gt") or hasattr(one, "ge"):
            is_open = hasattr(one, "gt")
            found = found._replace(low=one.gt if is_open else one.ge, open_low=is_open)
        elif hasattr(one, "lt") or hasattr(one, "le"):
            is_open = hasattr(one, "lt")
            found = found._replace(high=one.lt if is_open else one.le, open_high=is_open)
    return found
