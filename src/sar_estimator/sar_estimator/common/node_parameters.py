"""A node's parameters: declared from checked dataclasses, with range and description."""

from __future__ import annotations

import re
from dataclasses import MISSING, fields
from typing import Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterValueException
from rclpy.node import Node

from sar_estimator.common.checked import Bounds, bounds_of, read

T = TypeVar("T")

LARGEST_INTEGER = 2**63 - 1


def parameters(node: Node, kind: type[T]) -> T:
    """Return a checked dataclass filled from parameters of the same names (tuples as lists).

    A field whose default is None is a number that is not set while it is 0. Each parameter has its
    field's bounds as range, and is described as in the docstring of the dataclass. Only those named
    in its ``CHANGEABLE`` can be changed in flight: nodes read them when they start. Raises
    ``ValueError``: name, value, and what was expected.
    """
    texts, bounds = descriptions(kind), bounds_of(kind)
    values = {}
    for name, default in defaults_of(kind).items():
        descriptor = described(name, default, texts.get(name, ""), bounds[name])
        descriptor.read_only = name not in getattr(kind, "CHANGEABLE", ())
        value = _declared(node, default, descriptor)
        values[name] = None if default is None and not value else value
    try:
        return read(kind, values)
    except ValueError as error:
        raise ValueError(f"parameter {error}") from error


def defaults_of(kind: type[Any]) -> dict[str, Any]:
    """Return a checked dataclass's defaults by name; each field must have one."""
    found = {}
    for item in fields(kind):
        if item.default is MISSING:
            raise TypeError(f"{kind.__name__}.{item.name}: expected a default")
        found[item.name] = item.default
    return found


def described(name: str, default: Any, text: str, bounds: Bounds) -> ParameterDescriptor:
    """Return a parameter's description, with its range where that is bounded."""
    descriptor = ParameterDescriptor(
        name=name, description=text, dynamic_typing=True, read_only=True
    )
    if bounds == Bounds():
        return descriptor
    if isinstance(default, float) or default is None:
        # A bound that is no value itself is refused by what reads the value.
        ends = FloatingPointRange(from_value=bounds.low, to_value=bounds.high)
        descriptor.floating_point_range = [ends]
    elif isinstance(default, int) and not isinstance(default, bool):
        high = int(min(bounds.high, LARGEST_INTEGER))
        descriptor.integer_range = [IntegerRange(from_value=int(bounds.low), to_value=high, step=1)]
    return descriptor


def _declared(node: Node, default: Any, descriptor: ParameterDescriptor) -> Any:
    """Declare a parameter and return its value, of its default's type."""
    name = descriptor.name
    if default is None:
        default = 0.0
    elif isinstance(default, tuple):
        default = list(default)
    try:
        node.declare_parameter(name, default, descriptor)
    except InvalidParameterValueException as error:
        given = node._parameter_overrides[name].value  # noqa: SLF001 - no public way to it
        ends = (*descriptor.floating_point_range, *descriptor.integer_range)[0]
        wanted = Bounds(ends.from_value, ends.to_value)
        raise ValueError(f"parameter {name} = {given!r}: expected {wanted}") from error
    value = node.get_parameter(name).value
    whole = isinstance(value, int) and not isinstance(value, bool)
    if isinstance(default, float) and whole:
        return float(value)
    if isinstance(default, list) and not isinstance(value, str | bytes):
        return list(value) if hasattr(value, "__iter__") else value
    if type(value) is not type(default):
        raise ValueError(f"parameter {name} = {value!r}: expected a value like {default!r}")
    return value


def descriptions(kind: type[Any]) -> dict[str, str]:
    """Return what the docstring of a dataclass says of its fields, by name.

    As ``name: text`` or ``name, other: text``, which ends where the next name is described.
    """
    text = " ".join((kind.__doc__ or "").replace("``", "").split())
    names = "|".join(re.escape(item.name) for item in fields(kind))
    heads = list(re.finditer(rf"(?:(?:{names}), )*(?:{names}): ", text))
    found: dict[str, str] = {}
    ends = [*(head.start() for head in heads[1:]), len(text)]
    for head, end in zip(heads, ends, strict=False):
        said = text[head.end() : end].strip().rstrip(".;,")
        for name in re.findall(rf"\b(?:{names})\b", head.group()):
            found.setdefault(name, said)
    return found


def refuse_unknown_parameters(node: Node) -> None:
    """Raise ``ValueError`` for a parameter that was given and is none of the node's.

    Those of ROS itself, which may be declared later (``qos_overrides``), do not count.
    """
    known = node._parameters  # noqa: SLF001 - rclpy has no public list of what was given
    for name, given in node._parameter_overrides.items():  # noqa: SLF001
        if name not in known and not name.startswith("qos_overrides."):
            expected = ", ".join(sorted(known))
            raise ValueError(
                f"parameter {name} = {given.value}: unknown, expected one of {expected}"
            )
