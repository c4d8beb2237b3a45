"""Shell completion of a tool's options, by shtab."""

from __future__ import annotations

import argparse

import shtab


def add_completion(parser: argparse.ArgumentParser) -> None:
    """Add ``--print-completion bash`` (zsh, tcsh): what a shell evaluates."""
    shtab.add_argument_to(parser, "--print-completion", help="for a shell to evaluate")


def of_file(action: argparse.Action) -> None:
    """Complete an option with files."""
    action.complete = shtab.FILE  # type: ignore[attr-defined]


def of_folder(action: argparse.Action) -> None:
    """Complete an option with folders."""
    action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
