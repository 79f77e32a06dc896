"""The command line: arguments, progress, printing; no science.

Imports of the science stand inside the commands, so that ``--help`` answers at once.
"""

from drake_viapoint.cli.commands import cli, main

__all__ = ["cli", "main"]
