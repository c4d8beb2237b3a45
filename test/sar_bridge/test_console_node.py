"""What the page's node refuses to be told of UAVs."""

import pytest

from sar_bridge.console_node import ConsoleParameters


@pytest.mark.parametrize("uavs", [("",), ("uav1",), ("uav1", "uav2", "b_3")])
def test_names_of_namespaces_are_taken(uavs):
    assert ConsoleParameters(uavs=uavs).uavs == uavs


@pytest.mark.parametrize("uavs", [(), ("uav1", "uav1"), ("uav 1",), ("/uav1",), ("1",)])
def test_what_is_no_list_of_names_is_refused(uavs):
    with pytest.raises(ValueError, match=r"uavs = .*: expected different names"):
        ConsoleParameters(uavs=uavs)
