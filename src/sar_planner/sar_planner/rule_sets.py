"""The rule sets a planner can be started with, by name."""

from __future__ import annotations

from sar_planner.automaton import PaperAutomaton
from sar_planner.parameters import CornerParameters, ParameterError

RULE_SETS = ("paper", "deadbeat")


def make_rule_set(
    name: str, parameters: CornerParameters, *, enforce: bool = True
) -> PaperAutomaton:
    """Return the named rule set.

    ``enforce`` refuses parameters outside the rules' conditions: those a mission is started with,
    not those measured at one corner. Raises ``ParameterError`` for these and for unknown names.
    """
    if name == "paper":
        return PaperAutomaton(parameters, enforce=enforce)
    if name == "deadbeat":
        raise ParameterError("rules = deadbeat: not in this version, expected paper")
    raise ParameterError(f"rules = {name}: expected one of {', '.join(RULE_SETS)}")
