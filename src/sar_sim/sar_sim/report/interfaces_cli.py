"""``interfaces``: the graph's topics and services, or its parameters, as Markdown."""

from __future__ import annotations

import argparse
import sys

from sar_sim.report.interfaces import interfaces_text
from sar_sim.report.parameter_page import parameters_text


def main(argv: list[str] | None = None) -> int:
    """Print the page."""
    parser = argparse.ArgumentParser(prog="interfaces", description=__doc__)
    parser.add_argument("--parameters", action="store_true", help="the nodes' parameters instead")
    args = parser.parse_args(argv)
    sys.stdout.write(parameters_text() if args.parameters else interfaces_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
