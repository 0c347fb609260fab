"""The command line: `krhpr list`, `info`, `eval`, `generate`, `compile`, `validate`, `schema`; one module per
command.

SymPy, Jinja2, PyYAML and rich are imported inside the commands that need them: `list`, `info`, `eval` and
`compile` take NumPy alone (and PyYAML, where they are given a robot file).
"""

from krhpr.cli.app import main

__all__ = ["main"]
