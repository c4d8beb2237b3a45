from sar_bridge.session.liveness import Liveness


def test_a_node_that_was_heard_and_is_not_any_more_is_silent():
    nodes = Liveness(("planner", "monitor"), 3.0)
    assert nodes.silent(100.0) == ""  # never started: nothing is led without it
    nodes.hear("planner", 100.0)
    nodes.hear("monitor", 101.0)
    nodes.hear("launch", 0.0)
    assert nodes.silent(103.0) == ""
    assert nodes.silent(103.5) == "planner"
    nodes.hear("planner", 103.6)
    assert nodes.silent(104.5) == "monitor"
    nodes.hear("monitor", 104.6)
    assert nodes.silent(104.7) == ""
