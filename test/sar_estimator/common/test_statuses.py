"""Values become keys and texts of a status, and come back."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.statuses import Level, to_status, values_of

KEYS = st.text("abcdefg_", min_size=1, max_size=5)
TREES = st.dictionaries(
    KEYS,
    st.recursive(
        st.text(max_size=8),
        lambda inner: (
            st.dictionaries(KEYS, inner, min_size=1, max_size=3)
            | st.lists(inner, min_size=1, max_size=3)
        ),
        max_leaves=10,
    ),
    max_size=5,
)


@given(TREES)
def test_what_is_told_is_what_is_read(tree):
    assert values_of(to_status("it", tree)) == tree


@dataclass
class Sample:
    where: Pose
    names: tuple[str, ...]
    flag: bool
    unset: float | None = None


def test_keys_are_dotted_and_values_are_texts():
    status = to_status(
        "sample", Sample(Pose(1.0, 2.5, 0.1), ("a", "b"), flag=True), level=Level.WARN, message="x"
    )
    assert (status.level, status.name, status.message) == (b"\x01", "sample", "x")
    assert {item.key: item.value for item in status.values} == {
        "where.x_m": "1.0",
        "where.y_m": "2.5",
        "where.heading_rad": "0.1",
        "names.0": "a",
        "names.1": "b",
        "flag": "true",
    }
    assert values_of(status)["names"] == ["a", "b"]


@pytest.mark.parametrize("keys", [("a", "a.b"), ("a.b", "a.b.c"), ("a.b", "a"), ("a.b.c", "a.b")])
def test_a_key_is_a_value_or_a_mapping(keys):
    status = to_status("it", dict.fromkeys(keys, "1"))
    with pytest.raises(ValueError, match="expected no value beside"):
        values_of(status)


def test_a_key_of_nothing_but_dots_is_read():
    status = to_status("it", {"." * 5000: "1"})
    assert list(values_of(status)) == [""]
