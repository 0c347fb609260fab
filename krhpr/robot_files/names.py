"""Names of robots: they become parts of file names, C symbols and Python modules, and so are checked."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable

from krhpr.robot_files.problems import shown

LONGEST = 40
PATTERN = r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$"
"""What a name looks like, as Python and JSON Schema read it."""

# of C, up to C23, and of C++, up to C++20
_WORDS = """
alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool
break case catch char char8_t char16_t char32_t class compl concept const const_cast consteval
constexpr constinit continue co_await co_return co_yield decltype default delete do double
dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable
namespace new noexcept not not_eq nullptr operator or or_eq private protected public reflexpr
register reinterpret_cast requires restrict return short signed sizeof static static_assert
static_cast struct switch synchronized template this thread_local throw true try typedef typeid
typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
_C_WORDS = frozenset(_WORDS.split())

_OWN = frozenset(
    {"subleg", "platform", "algebra", "elementary", "casadi", "dual", "runtime", "limits", "krhpr"}
)
"""First words of files and symbols that every generated folder has."""

_TAKEN = frozenset({"c", "python", "import_module"})
"""Names that mean something else in a generated folder."""

_DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{d}{n}" for d in ("com", "lpt") for n in range(1, 10))})
"""Names that no file has on Windows."""


def wrong_name(name: str, catalogue: Iterable[str]) -> str | None:
    """Why a robot cannot be called so; None where it can."""
    if len(name) > LONGEST or not re.fullmatch(PATTERN, name) or not name.isascii():
        return (
            f"found {shown(name)}, expected a name of lower-case letters, digits and single underscores that "
            f"begins with a letter, {LONGEST} characters at most"
        )
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        return f"found {shown(name)}, which is a word of Python; choose another name"
    if name in _C_WORDS:
        return f"found {shown(name)}, which is a word of C or C++; choose another name"
    if name in catalogue:
        return (
            f"found {shown(name)}, which is a robot of the catalogue: both would have the same files and "
            "symbols; choose another name"
        )
    if name.split("_", maxsplit=1)[0] in _OWN or name in _TAKEN or name in _DEVICES:
        return f"found {shown(name)}, which generated code uses itself; choose another name"
    return None
