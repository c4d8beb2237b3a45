"""The planners by name: those with a rule set, and one that only follows its slot point."""

from __future__ import annotations

from functools import lru_cache

from sar_planner.parameters.corner import PLANNERS, RULE_SETS, CornerParameters, ParameterError
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton
from sar_planner.rules.paper_automaton import PaperAutomaton


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


@lru_cache(maxsize=64)  # one mission after another has the same parameters
def check_planner(name: str, parameters: CornerParameters) -> None:
    """Refuse an unknown planner, and parameters outside the conditions of its rules.

    Raises ``ParameterError``.
    """
    if name not in PLANNERS:
        raise ParameterError(f"rules = {name}: expected one of {', '.join(PLANNERS)}")
    if name in RULE_SETS:
        make_rule_set(name, parameters)
