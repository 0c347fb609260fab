"""`krhpr schema`: the JSON schema of robot files."""

from __future__ import annotations

import argparse
import sys
from importlib.resources import files

from krhpr.cli.common import Command, Exit
from krhpr.errors import GeneratedMismatch


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments: none."""


def run(options: argparse.Namespace) -> int:
    """Print the schema."""
    place = files("krhpr.generated") / "robot-file.schema.json"
    try:
        text = place.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise GeneratedMismatch("the schema is missing; run `krhpr generate` (or `make generate`)") from None
    sys.stdout.write(text)
    return Exit.OK


COMMAND = Command(
    "schema",
    "Print the JSON schema of robot files.  Editors complete and check a file with it.",
    "examples:\n  krhpr schema > robot-file.schema.json",
    add_arguments,
    run,
)
