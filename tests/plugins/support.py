"""What the tests of plugins share."""

from __future__ import annotations

import re
from typing import Any

from tests.support import ROOT

EXAMPLE = ROOT / "examples" / "plugins" / "offset_wrist.py"
GUIDE = ROOT / "docs" / "adding-a-sub-leg.md"


def closed_form() -> Any:
    """The plugin that the guide makes of the example by adding `inverse`."""
    blocks = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    (code,) = [block for block in blocks if "def inverse" in block and "load_plugin" in block]
    code = code.replace('"examples/plugins/offset_wrist.py"', repr(str(EXAMPLE)))
    names: dict[str, Any] = {}
    exec(compile(code, "the guide", "exec"), names)
    return names["PLUGIN"]
