"""An interpreter of the C that this project prints, over any of the number types of `numbers`.

It runs the printed text itself, so that a slip of the printer (a sign, an index, an integer division) shows,
and it checks memory on the way: reading what was never written, or outside an object, raises with name and
line.

Numbers follow the C types: a `double` holds a number of the chosen arithmetic, integers are Python integers
with C's rules (truncating division; overflow of signed types raises).  A floating literal stands for the
decimal number that it shows, not for the nearest double.  `Unsupported` names the line of anything outside
the subset: declarations, `for`, `if`, `return`, `break`, `continue`, expressions, calls, structs,
enumerations, macros and the math functions in `calls.MATH_FUNCTIONS`.

The way of a text: `preprocessor`, pycparser, `program`, which compiles functions when they are first needed
to closures (`compiled`) by `statements`, `initialisers` and `expressions`; these lean on `scope`, `places`,
`operators`, `conversions` and `calls`.  Below lie `declarations`, `memory`, `pointers`, `integers`, `types`
and `errors`.
"""

from krhpr.validation.c_interpreter.errors import CError, OutOfBounds, UninitialisedRead, Unsupported
from krhpr.validation.c_interpreter.memory import Array, Struct
from krhpr.validation.c_interpreter.program import CProgram

__all__ = ["Array", "CError", "CProgram", "OutOfBounds", "Struct", "UninitialisedRead", "Unsupported"]
