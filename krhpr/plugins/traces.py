"""Where in its author's file a plugin failed."""

from __future__ import annotations

import traceback


def told(error: BaseException, source: str, while_: str) -> str:
    """What happened, at the last line of the author's file that was running."""
    if isinstance(error, SyntaxError) and error.filename == source:
        return f"{source}, line {error.lineno}: {error.msg}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == source]
    place = f"{source}, line {frames[-1].lineno}, in {frames[-1].name}" if frames else source
    doing = f" while {while_}" if while_ else ""
    return f"{place}{doing}: {type(error).__name__}: {error}"
