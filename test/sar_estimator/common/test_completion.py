"""What is printed for a shell is what the shell can read, and completes options."""

import argparse
import shutil
import subprocess

import pytest

from sar_estimator.common.completion import add_completion, of_file, of_folder


def printed(capsys):
    parser = argparse.ArgumentParser(prog="tool")
    of_file(parser.add_argument("--params"))
    of_folder(parser.add_argument("--tiles"))
    parser.add_argument("--rules", choices=("deadbeat", "paper"))
    add_completion(parser)
    with pytest.raises(SystemExit) as ended:
        parser.parse_args(["--print-completion", "bash"])
    assert ended.value.code == 0
    return capsys.readouterr().out


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completes_options_and_their_values(capsys):
    script = printed(capsys) + (
        '\nCOMP_WORDS=(tool "--ru"); COMP_CWORD=1; _shtab_tool; echo "${COMPREPLY[@]}"'
        '\nCOMP_WORDS=(tool "--rules" "p"); COMP_CWORD=2; _shtab_tool; echo "${COMPREPLY[@]}"'
    )
    found = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, timeout=30, check=True
    )
    assert found.stdout.split() == ["--rules", "paper"]
