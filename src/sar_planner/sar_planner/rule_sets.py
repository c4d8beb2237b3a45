"""The rule sets a planner can be started with, by name."""

from __future__ import annotations

from sar_planner.automaton import PaperAutomaton
from sar_planner.deadbeat_automaton import DeadbeatAutomaton
from sar_planner.parameters import CornerParameters, ParameterError

RULE_SETS = ("deadbeat", "paper")


def make_rule_set(
    name: str, parameters: CornerParameters, *, enforce: bool = True
) -> PaperAutomaton | DeadbeatAutomaton:
    """Return the named rule set.

    ``enforce`` refuses parameters outside the rules' conditions: those a mission is started with,
    not those measured at one corner. Raises ``ParameterError`` for these and for unknown names.
    """
    if name == "paper":
        return PaperAutomaton(parameters, enforce=enforce)
    if name == "deadbeat":
        return DeadbeatAutomaton(parameters, enforce=enforce)
    raise ParameterError(f"rules = {name}: expected one of {', '.join(RULE_SETS)}")
