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
        (f"share/{NAME}/launch", ["launch/formation.launch.py"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "sim = sar_sim.nodes.sim_node:main",
            "record = sar_sim.nodes.record_node:main",
            "play = sar_sim.nodes.play_node:main",
            "import_track = sar_sim.bags.import_track:main",
            "tracking = sar_sim.trials.tracking_cli:main",
            "upload_benchmark = sar_sim.trials.radio_cli:main",
            "bench = sar_sim.bench.bench_cli:main",
            "campaign = sar_sim.campaign.campaign_cli:main",
            "monitor_trials = sar_sim.trials.monitor_trials_cli:main",
            "enclosure = sar_sim.trials.enclosure_cli:main",
            "export = sar_sim.export.export_cli:main",
            "find_trials = sar_sim.trials.find_trials_cli:main",
            "formation_trials = sar_sim.trials.formation_trials_cli:main",
            "receiver = sar_sim.trials.receiver_cli:main",
            "receiver_logs = sar_sim.trials.receiver_logs_cli:main",
            "rejoin_trials = sar_sim.trials.rejoin_trials_cli:main",
            "separation_trials = sar_sim.trials.separation_trials_cli:main",
            "results = sar_sim.results.results_cli:main",
            "rules_figure = sar_sim.results.rules_figure_cli:main",
            "detection = sar_sim.campaign.detection_cli:main",
            "replay = sar_sim.flight.replay_cli:main",
            "report = sar_sim.report.report_cli:main",
            "loaded_flights = sar_sim.trials.loaded_flights_cli:main",
            "faults = sar_sim.trials.faults_cli:main",
            "fly = sar_sim.flight.fly_cli:main",
            "interfaces = sar_sim.report.interfaces_cli:main",
            "launch = sar_sim.launch.launch_cli:main",
        ],
    },
)
