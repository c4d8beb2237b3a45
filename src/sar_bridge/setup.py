"""colcon entry: the name, version and description are read from package.xml."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

MANIFEST = ElementTree.parse(Path(__file__).with_name("package.xml")).getroot()
NAME = MANIFEST.findtext("name")

setup(
    name=NAME,
    version=MANIFEST.findtext("version"),
    description=MANIFEST.findtext("description"),
    license="Apache-2.0",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "bridge = sar_bridge.bridge_node:main",
            "console = sar_bridge.console_node:main",
            "monitor = sar_bridge.monitor_node:main",
            "operator = sar_bridge.operator_node:main",
            "radio_hub = sar_bridge.radio_hub_node:main",
        ],
    },
)
