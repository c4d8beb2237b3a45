#!/usr/bin/env bash
# Second command: sets up, builds, checks and tests. Options go to pytest, in one process.
set -eu
cd "$(dirname "$(readlink -f "$0")")"
./launch.sh --setup
venv=.venv
[ "${ROS_DISTRO:-}" != jazzy ] || venv=.venv-ros
# shellcheck disable=SC1091
. "$venv/bin/activate"
wanted="$(sha256sum <requirements-test.txt)"
if [ ! -f $venv/.test ] || [ "$(cat $venv/.test)" != "$wanted" ]; then
    pip install --quiet --disable-pip-version-check -r requirements-test.txt
    echo "$wanted" >$venv/.test
fi
# shellcheck disable=SC1091
set +u && . install/setup.bash && set -u
export OPENBLAS_NUM_THREADS=1
ruff check src test
ruff format --check src test
mypy
[ $# -eq 0 ] || exec python -m pytest "$@"
# What computes, on all cores; then what measures real processes, two tests at a time, each in a ROS
# domain of its own. A test that hangs ends its worker (--timeout), and a worker that dies the run.
timeout --kill-after=10 2400 python -m pytest -m "not graph and not proof" \
    --numprocesses auto --dist loadfile --max-worker-restart 0
exec timeout --kill-after=10 2400 python -m pytest -m graph \
    --numprocesses "$(($(nproc) < 2 ? 1 : 2))" --dist worksteal --max-worker-restart 0
