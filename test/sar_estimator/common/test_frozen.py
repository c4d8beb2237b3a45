"""Frozen dataclasses with other values of some fields."""

from dataclasses import dataclass, replace

import pytest

from sar_estimator.common.frozen import replaced


@dataclass(frozen=True)
class Speeds:
    """Checked as it is made."""

    slowest: float
    fastest: float = 30.0

    def __post_init__(self) -> None:
        """Check the order."""
        if self.slowest > self.fastest:
            raise ValueError(f"{self.slowest}: expected at most {self.fastest}")


def test_is_as_dataclasses_make_it():
    one = Speeds(10.0)
    assert replaced(one, slowest=12.0) == replace(one, slowest=12.0) == Speeds(12.0)
    assert one == Speeds(10.0)


def test_is_checked_as_a_new_one():
    with pytest.raises(ValueError, match="expected at most"):
        replaced(Speeds(10.0), slowest=40.0)


def test_refuses_fields_that_there_are_not():
    with pytest.raises(TypeError, match="Speeds: unknown field slow"):
        replaced(Speeds(10.0), slow=1.0)
