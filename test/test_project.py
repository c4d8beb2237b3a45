"""What holds for the whole tree."""

import re
import subprocess
from dataclasses import fields
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml

from sar_bridge.separation_monitor import MonitorParameters
from sar_estimator.parameters import EstimatorParameters
from sar_planner.mission_parameters import MissionParameters
from sar_planner.parameters import CornerParameters

ROOT = Path(__file__).parents[1]
SOURCES = sorted((ROOT / "src").glob("*/sar_*/*.py"))
INPUT_OUTPUT = {"node_support", "link", "processes", "home_link", "pool", "kept"}
PURE = [
    path
    for path in SOURCES
    if not path.stem.endswith(("_node", "_cli")) and path.stem not in INPUT_OUTPUT
]
UNSET = {
    "taylor_y_m": "0 (exact)",
    "min_separation_m": "0 (0.8 d)",
    "caution_separation_m": "0 (0.85 of the least)",
    "warning_separation_m": "0 (0.75 of the least)",
    "escape_separation_m": "0 (0.65 of the least)",
}


def test_one_version():
    versions = {
        ET.parse(path).getroot().findtext("version")
        for path in (ROOT / "src").glob("*/package.xml")
    }
    assert len(versions) == 1
    assert f"## {versions.pop()}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_nodes_alone_import_rclpy(path):
    text = path.read_text(encoding="utf-8")
    imports = re.findall(r"^[ \t]*(?:from|import) rclpy\S*", text, re.MULTILINE)
    assert imports == [] or path.stem.endswith("_node") or path.stem == "node_support"


@pytest.mark.parametrize("path", PURE, ids=lambda path: path.stem)
def test_pure_modules_read_no_clock(path):
    text = path.read_text(encoding="utf-8")
    if path.stem != "options":
        assert "time.time(" not in text
        assert "time.monotonic(" not in text


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_files_are_short(path):
    limit = 250 if path.stem.endswith("_node") else 600
    assert len(path.read_text(encoding="utf-8").splitlines()) <= limit


def test_every_executable_is_documented():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for setup in (ROOT / "src").glob("*/setup.py"):
        for name in re.findall(r'"(\w+) = \w+\.\w+:main"', setup.read_text(encoding="utf-8")):
            assert f"`{name}" in readme or f" {name} " in readme, name


@pytest.mark.parametrize("script", ["launch.sh", "run_tests.sh", ".ci/run"])
def test_scripts_are_executable_and_sound(script):
    path = ROOT / script
    assert path.stat().st_mode & 0o111
    assert subprocess.run(["bash", "-n", str(path)], check=False).returncode == 0


def documented(node):
    """Return the parameters of a node in the documents: defaults by name."""
    text = (ROOT / "docs/parameters.md").read_text("utf-8")
    section = next(part for part in text.split("\n## ") if part.startswith(node))
    return dict(re.findall(r"^\| `(\w+)` \| (.+?) \|", section, re.MULTILINE))


@pytest.mark.parametrize(
    ("kind", "node"),
    [
        (EstimatorParameters, "estimator"),
        (CornerParameters, "planner"),
        (MissionParameters, "planner"),
        (MonitorParameters, "monitor"),
    ],
)
def test_every_parameter_is_documented_with_its_default(kind, node):
    rows = documented(node)
    for item in fields(kind):
        default = item.default
        text = str(list(default)) if isinstance(default, tuple) else str(default)
        if default is None:
            text = UNSET[item.name]
        assert rows[item.name] == text, item.name


def test_shipped_parameter_file_names_only_known_parameters():
    known = set(re.findall(r"`(\w+)`", (ROOT / "docs/parameters.md").read_text("utf-8")))
    document = yaml.safe_load((ROOT / "config/params.yaml").read_text("utf-8"))
    for block in document.values():
        assert set(block["ros__parameters"]) <= known
