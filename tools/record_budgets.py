"""Record the operations of every kernel as its budget, and say what changed.

    python tools/record_budgets.py        (or: make budgets)

`tests/codegen/test_budgets.py` fails where a kernel takes more than recorded; run this where that is meant,
and commit the file with the reason.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from krhpr.codegen.part import Part
from krhpr.codegen.pipeline import derive

BUDGETS = Path(__file__).resolve().parent.parent / "tests" / "codegen" / "budgets.json"


def operations(parts: Iterable[Part]) -> dict[str, int]:
    """Operations of one call of every kernel, `prepare` included."""
    found = {}
    for part in sorted(parts, key=lambda part: part.name):
        prepare = (part.geometry.prepare,) if part.geometry is not None else ()
        for kernel in (*prepare, *part.kernels):
            found[f"{part.name}.{kernel.name}"] = kernel.operations.total
    return found


def main() -> None:
    before = json.loads(BUDGETS.read_text(encoding="utf-8")) if BUDGETS.exists() else {}
    after = operations(derive().parts)
    for name in sorted(before.keys() | after.keys()):
        old, new = before.get(name), after.get(name)
        if old != new:
            print(f"{name}: {'new' if old is None else old} -> {'gone' if new is None else new}")
    BUDGETS.write_text(json.dumps(after, indent=1) + "\n", encoding="utf-8")
    print(f"{len(after)} kernels in {BUDGETS}")


if __name__ == "__main__":
    main()
