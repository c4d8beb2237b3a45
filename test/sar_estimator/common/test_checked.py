"""Values are read as declared, or refused in one line: key, value, what was expected."""

import math
from dataclasses import field
from typing import Annotated, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import (
    CHECKED,
    Bounds,
    Count,
    NotNegative,
    Positive,
    PositiveRange,
    Share,
    Side,
    Word,
    bounds_of,
    changed,
    choices_of,
    read,
)


@dataclass(frozen=True, slots=True, config=CHECKED)
class Inner:
    """What is within."""

    length_m: Positive = 1.0
    optional_m: Positive | None = None
    angle_deg: Annotated[float, Field(gt=0.0, lt=180.0)] = 90.0
    share: Share = 0.5
    count: Count = 3
    on: bool = False
    shape: Literal["disc", "square"] = "disc"
    side: Side = 1
    word: Word = "off"
    limits: PositiveRange = (1.0, 2.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        if self.limits[0] > self.limits[1]:
            raise ValueError(f"limits = {self.limits}: expected low <= high")


@dataclass(frozen=True, slots=True, config=CHECKED)
class Outer:
    """What is read."""

    inner: Inner = field(default_factory=Inner)
    more: list[Inner] = field(default_factory=list)
    weight: NotNegative = 0.0


def test_plain_values_become_what_is_declared():
    found = read(Outer, {"inner": {"length_m": 2, "limits": [3, 4], "word": False}, "more": [{}]})
    assert found == Outer(Inner(length_m=2.0, limits=(3.0, 4.0)), [Inner()])
    assert isinstance(found.inner.length_m, float)


def test_texts_serve_as_numbers_only_where_that_is_said():
    values = {"inner": {"length_m": "2.5", "count": "4", "on": "true", "side": "-1"}}
    assert read(Outer, values, texts=True).inner == Inner(2.5, count=4, on=True, side=-1)
    with pytest.raises(ValueError, match=r"inner.length_m = '2.5': expected a number"):
        read(Outer, values)


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"inner": {"length_m": 0}}, "a.inner.length_m = 0: expected more than 0"),
        ({"inner": {"optional_m": -1}}, "a.inner.optional_m = -1: expected more than 0"),
        ({"inner": {"length_m": True}}, "a.inner.length_m = True: expected a number"),
        ({"inner": {"length_m": math.nan}}, "a.inner.length_m = nan: expected a number"),
        ({"inner": {"length_m": None}}, "a.inner.length_m = None: expected a number"),
        (
            {"inner": {"angle_deg": 180}},
            "a.inner.angle_deg = 180: expected more than 0, less than 180",
        ),
        ({"inner": {"share": 1.5}}, "a.inner.share = 1.5: expected 0 to 1"),
        ({"inner": {"count": 2.5}}, "a.inner.count = 2.5: expected a whole number"),
        ({"inner": {"count": 0}}, "a.inner.count = 0: expected 1 or more"),
        ({"inner": {"on": "maybe"}}, "a.inner.on = 'maybe': expected true or false"),
        ({"inner": {"shape": "star"}}, "a.inner.shape = 'star': expected disc or square"),
        ({"inner": {"side": 0}}, "a.inner.side = 0: expected 1 or -1"),
        ({"inner": {"word": 3}}, "a.inner.word = 3: expected a text"),
        ({"inner": {"limits": [2, 1]}}, "a.inner.limits = (2.0, 1.0): expected low <= high"),
        ({"inner": {"limits": [1, 0]}}, "a.inner.limits[1] = 0: expected more than 0"),
        ({"inner": {"limits": 3}}, "a.inner.limits = 3: expected a list"),
        ({"inner": 3}, "a.inner = 3: expected a mapping"),
        ({"more": {}}, "a.more = {}: expected a list"),
        ({"more": [{}, {"count": 0}]}, "a.more[1].count = 0: expected 1 or more"),
        ({"more": [7]}, "a.more[0] = 7: expected a mapping"),
        ({"weigt": 1}, "a.weigt: unknown key, expected one of inner, more, weight"),
        (
            {"inner": {"size": 1}},
            "a.inner.size: unknown key, expected one of length_m, optional_m, angle_deg, share,",
        ),
        (3, "a = 3: expected a mapping"),
        ({(1, 2): 3}, "a: keys must be str, int, float, bool or None, not tuple: expected texts"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(values, line):
    with pytest.raises(ValueError, match="expected") as error:
        read(Outer, values, "a")
    assert str(error.value).startswith(line)
    assert "\n" not in str(error.value)


def test_a_change_is_checked_too():
    assert changed(Inner(), count=5) == Inner(count=5)
    with pytest.raises(ValueError, match=r"^count = 0: expected 1 or more$"):
        changed(Inner(), count=0)


def test_bounds_and_choices_are_told():
    found = bounds_of(Inner)
    assert found["length_m"] == found["optional_m"] == Bounds(low=0.0, open_low=True)
    assert str(found["angle_deg"]) == "more than 0, less than 180"
    assert str(found["shape"]) == ""
    assert choices_of(Inner) == {"shape": ("disc", "square"), "side": (1, -1)}
    assert str(Bounds(high=3.0)) == "at most 3"
    assert str(Bounds(high=3.0, open_high=True)) == "less than 3"


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(
                st.sampled_from(["inner", "more", "length_m", "count", "limits", "x"]), inner
            )
        ),
        max_leaves=12,
    )
)
def test_anything_is_read_or_refused_in_one_line(values):
    for texts in (False, True):
        try:
            found = read(Outer, values, texts=texts)
        except ValueError as error:
            assert "\n" not in str(error).replace(repr(values), "")  # noqa: PT017
        else:
            assert isinstance(found, Outer)
