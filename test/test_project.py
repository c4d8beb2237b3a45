"""What holds for the whole tree."""

import ast
import graphlib
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from xml.etree import ElementTree as ET

import pytest
import yaml

from sar_estimator.common.wires import WIRES

ROOT = Path(__file__).parents[1]
SOURCES = sorted((ROOT / "src").glob("*/sar_*/**/*.py"))
SHELLS = {
    "sar_bridge/console/live",
    "sar_bridge/console/map_panel",
    "sar_bridge/console/page",
    "sar_bridge/mavlink/hub",
    "sar_bridge/mavlink/link",
    "sar_bridge/mavlink/station_link",
    "sar_estimator/common/node_support",
    "sar_estimator/common/priorities",
    "sar_estimator/gps/source",
    "sar_sim/autopilot/home_link",
    "sar_sim/autopilot/link",
    "sar_sim/jobs/pool",
    "sar_sim/jobs/processes",
    "sar_sim/jobs/result_cache",
    "sar_sim/launch/dds_cut",
    "sar_sim/scenario/options",
    "sar_sim/trials/fault_runs",
    "sar_sim/trials/receiver_terminal",
}
CLOCKS_AND_PROCESSES = {"rclpy", "serial", "signal", "socket", "subprocess", "threading", "time"}


def name_of(path):
    """Return a module's path inside its package folder, without the suffix."""
    return path.relative_to(ROOT / "src").with_suffix("").as_posix().partition("/")[2]


def is_shell(path):
    """Whether a module may read clocks and start processes: nodes, commands, and few others."""
    return (
        path.stem.endswith(("_node", "_cli")) or "/cli/" in name_of(path) or name_of(path) in SHELLS
    )


def imported(path):
    """Return the modules that a file imports, at any depth of its code."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def test_one_version():
    versions = {
        ET.parse(path).getroot().findtext("version")
        for path in (ROOT / "src").glob("*/package.xml")
    }
    assert len(versions) == 1
    assert f"## {versions.pop()}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_shells_are_modules():
    assert set(map(name_of, SOURCES)) >= SHELLS


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_only_shells_know_rclpy_clocks_and_processes(path):
    known = {name.partition(".")[0] for name in imported(path)} & CLOCKS_AND_PROCESSES
    if path.stem.endswith("_node") or path.stem in ("node_support", "node_parameters"):
        return
    assert "rclpy" not in known
    assert not known or is_shell(path), known


def test_rooms_lead_to_each_other_without_circles():
    rooms = {}
    modules = {name_of(path).replace("/", "."): path for path in SOURCES}
    for name, path in modules.items():
        room = name.rpartition(".")[0]
        wanted = {one.rpartition(".")[0] for one in imported(path) & modules.keys()}
        if "." in room:
            rooms.setdefault(room, set()).update(wanted - {room})
    assert list(graphlib.TopologicalSorter(rooms).static_order())


@pytest.mark.parametrize(
    "path", sorted((ROOT / "test").glob("sar_*/**/test_*.py")), ids=lambda path: path.stem
)
def test_tests_stand_in_the_room_of_what_they_test(path):
    package, *rooms = path.relative_to(ROOT / "test").parent.parts
    assert (ROOT / "src" / package / package / Path(*rooms) / "__init__.py").is_file()


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_files_are_short(path):
    limit = 250 if path.stem.endswith("_node") else 600
    assert len(path.read_text(encoding="utf-8").splitlines()) <= limit


def test_g_has_one_value():
    texts = {name_of(path): path.read_text(encoding="utf-8") for path in SOURCES}
    assert [name for name, text in texts.items() if re.search(r"\b9\.8\d*\b", text)] == [
        "sar_estimator/common/constants"
    ]


REASON = "In one piece: "


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_classes_and_functions_are_short_or_say_why_they_are_not(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            limit = 250 if isinstance(node, ast.ClassDef) else 60
            size = node.end_lineno - node.lineno + 1
            said = " ".join((ast.get_docstring(node) or "").split())
            assert size <= limit or REASON in said, f"{node.name}: {size} lines"


def test_every_executable_is_documented_and_nothing_else():
    page = (ROOT / "docs/tools.md").read_text(encoding="utf-8")
    table = page.partition("| package | tool |")[2].partition("\n\n")[0]
    named = set(re.findall(r"^\| (?:`\w+` )?\| `(\w+)` \|", table, re.MULTILINE))
    named |= set(re.findall(r"^\| `sar_\w+` \| `(\w+)` \|", table, re.MULTILINE))
    assert named == {name for _, name in executables()}


def test_the_readme_is_short_and_its_links_lead_somewhere():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(readme.split()) <= 1000
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / link).exists(), (page.name, link)


PAGES = [
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    *(f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md"))),
]


@pytest.mark.parametrize("page", PAGES)
def test_lines_are_at_most_100_columns(page):
    """But for tables, and what commands print."""
    text = re.sub(r"```.*?```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    for line in text.splitlines():
        assert len(line) <= 100 or line.startswith(("|", "![")), line


@pytest.mark.parametrize("script", ["launch.sh", "run_tests.sh", ".ci/run"])
def test_scripts_are_executable_and_sound(script):
    path = ROOT / script
    assert path.stat().st_mode & 0o111
    assert subprocess.run(["bash", "-n", str(path)], check=False).returncode == 0


def test_shipped_parameter_file_names_only_known_parameters():
    known = set(re.findall(r"`(\w+)`", (ROOT / "docs/parameters.md").read_text("utf-8")))
    document = yaml.safe_load((ROOT / "config/params.yaml").read_text("utf-8"))
    for block in document.values():
        assert set(block["ros__parameters"]) <= known


KEYS = {
    "filterpy": "python3-filterpy-pip",
    "flint": "python3-flint-pip",
    "matplotlib": "python3-matplotlib",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "pydantic": "python3-pydantic-pip",
    "pymap3d": "python3-pymap3d",
    "pymavlink": "python3-pymavlink-pip",
    "pynmeagps": "python3-pynmeagps-pip",
    "pyrtcm": "python3-pyrtcm-pip",
    "pyubx2": "python3-pyubx2-pip",
    "rosbags": "python3-rosbags-pip",
    "scipy": "python3-scipy",
    "serial": "python3-serial",
    "shapely": "python3-shapely",
    "tqdm": "python3-tqdm",
    "yaml": "python3-yaml",
}
ROS = re.compile(r"\w+_(msgs|srvs|interfaces)|rclpy|ament_index_python|sar_\w+")


@pytest.mark.parametrize("package", ["sar_estimator", "sar_planner", "sar_bridge", "sar_sim"])
def test_a_manifest_names_what_is_imported_and_nothing_else(package):
    folder = ROOT / "src" / package
    names = set()
    for path in SOURCES:
        if path.is_relative_to(folder):
            names |= {name.partition(".")[0] for name in imported(path)}
    wanted = {KEYS[name] for name in names & KEYS.keys()}
    wanted |= {name for name in names if ROS.fullmatch(name)} - {package}
    found = {one.text for one in ET.parse(folder / "package.xml").getroot().iter("exec_depend")}
    assert found == wanted


def executables():
    return {
        (setup.parent.name, name)
        for setup in (ROOT / "src").glob("*/setup.py")
        for name in re.findall(r'"(\w+) = [\w.]+:main"', setup.read_text(encoding="utf-8"))
    }


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({}, ["estimator", "planner", "monitor", "bridge"]),
        ({"bag": "b"}, ["estimator", "planner", "monitor", "bridge", "record"]),
        ({"estimator": "false", "namespace": "uav2"}, ["planner", "monitor", "bridge"]),
    ],
)
def test_the_launch_file_starts_what_there_is(monkeypatch, given, names):
    """Run with stand-ins: launch_ros is only there where ROS is installed."""
    launch, actions, substitutions, ros = (ModuleType(name) for name in "abcd")
    launch.LaunchContext, launch.LaunchDescription = dict, list
    actions.DeclareLaunchArgument = lambda name, **_: name
    actions.OpaqueFunction = lambda function: function
    substitutions.LaunchConfiguration = lambda name: SimpleNamespace(
        perform=lambda context: context[name]
    )
    ros.Node = SimpleNamespace
    for name, module in (
        ("launch", launch),
        ("launch.actions", actions),
        ("launch.substitutions", substitutions),
        ("launch_ros", ModuleType("launch_ros")),
        ("launch_ros.actions", ros),
    ):
        monkeypatch.setitem(sys.modules, name, module)
    found = runpy.run_path(str(ROOT / "src/sar_sim/launch/formation.launch.py"))
    *declared, function = found["generate_launch_description"]()
    assert declared == list(found["ARGUMENTS"])
    values = {name: default for name, (default, _) in found["ARGUMENTS"].items()} | given
    started = function(values)
    assert [one.executable for one in started] == names
    assert {(one.package, one.executable) for one in started} <= executables()
    led = [one for one in started if one.executable in ("planner", "monitor", "bridge")]
    assert {one.namespace for one in led} == {values["namespace"]}


@pytest.mark.parametrize("file", ["rviz/formation.rviz", "foxglove/formation.json"])
def test_what_is_shown_is_published(file):
    text = (ROOT / "config" / file).read_text(encoding="utf-8")
    assert isinstance(yaml.safe_load(text), dict)
    shown = set(re.findall(r"(?<![\w<])(/[a-z]+(?:/[a-z]+)?)(?=[\s\".])", text))
    assert shown
    assert shown <= set(WIRES)


def test_hooks_run_what_the_tests_run():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
    entries = [hook["entry"] for repo in hooks["repos"] for hook in repo["hooks"]]
    script = (ROOT / "run_tests.sh").read_text(encoding="utf-8")
    for tool in ("ruff check", "ruff format --check", "mypy"):
        assert any(tool in entry for entry in entries)
        assert tool in script


def test_the_hook_of_subjects_refuses_long_ones_alone():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
    (entry,) = (
        hook["entry"]
        for repo in hooks["repos"]
        for hook in repo["hooks"]
        if hook["id"] == "subject"
    )
    refused = re.compile(entry, re.MULTILINE)  # as pre-commit's pygrep matches a whole file
    assert refused.search("s" * 73 + "\n")
    assert not refused.search("s" * 72 + "\n\n" + "a body's line " * 9)
