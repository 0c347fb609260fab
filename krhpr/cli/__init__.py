"""The command line: `krhpr list`, `info`, `generate`, `compile`, `validate`, `eval`; one module per command.

SymPy, Jinja2 and rich are imported inside the commands that need them: `list`, `info` and `eval` take NumPy alone.
"""

from krhpr.cli.app import main

__all__ = ["main"]
