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
            "sim = sar_sim.sim_node:main",
            "record = sar_sim.record_node:main",
            "play = sar_sim.play_node:main",
            "import_track = sar_sim.import_track:main",
            "tracking = sar_sim.tracking_cli:main",
            "upload_benchmark = sar_sim.radio_cli:main",
            "bench = sar_sim.bench_cli:main",
            "campaign = sar_sim.campaign_cli:main",
            "monitor_trials = sar_sim.monitor_trials_cli:main",
            "rejoin_trials = sar_sim.rejoin_trials_cli:main",
            "results = sar_sim.results_cli:main",
            "rules_figure = sar_sim.rules_figure_cli:main",
            "detection = sar_sim.detection_cli:main",
            "replay = sar_sim.replay_cli:main",
            "report = sar_sim.report_cli:main",
            "faults = sar_sim.faults_cli:main",
            "fly = sar_sim.fly_cli:main",
            "launch = sar_sim.launch_cli:main",
        ],
    },
)
