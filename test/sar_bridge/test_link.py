import pytest

from sar_bridge.link import check_url


@pytest.mark.parametrize(
    "url", ["udp:127.0.0.1:14550", "tcp:127.0.0.1:5760", "/dev/ttyUSB0,57600", "/dev/ttyACM0"]
)
def test_good_urls(url):
    check_url(url)


@pytest.mark.parametrize(
    "url", ["", "udp:14550", "tcp:host:port", "udp:127.0.0.1:99999", "COM3", "/dev/ttyUSB0,fast"]
)
def test_bad_urls_say_what_was_expected(url):
    with pytest.raises(ValueError, match=r"autopilot URL .*: expected"):
        check_url(url)
