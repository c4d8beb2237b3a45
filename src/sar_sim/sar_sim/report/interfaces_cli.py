"""``interfaces``: the graph's topics and services, from what nodes declare, as Markdown."""

from __future__ import annotations

import argparse
import sys

from sar_sim.report.interfaces import interfaces_text


def main(argv: list[str] | None = None) -> int:
    """Print the page."""
    argparse.ArgumentParser(prog="interfaces", description=__doc__).parse_args(argv)
    sys.stdout.write(interfaces_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
