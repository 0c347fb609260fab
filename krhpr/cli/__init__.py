"""The command line: `krhpr list`, `info`, `eval`, `generate`, `compile`, `validate`; one module per command.

SymPy, Jinja2 and rich are imported inside the commands that need them: `list`, `info`, `eval` and `compile`
take NumPy alone.
"""

from krhpr.cli.app import main

__all__ = ["main"]
