"""Macros, conditionals and comments."""

from __future__ import annotations

from krhpr.validation.c_interpreter import CProgram
from krhpr.validation.numbers import Angle


def test_the_preprocessor() -> None:
    text = r"""
    #define TWO 2
    #define FOUR (TWO*TWO) // a comment
    #define LONG_ONE 1 + \
        FOUR
    #if defined(TWO) && !defined(THREE) && __STDC_VERSION__ >= 199901L
    #  define PICK 10
    #elif 1
    #  error unreachable
    #else
    #  error unreachable
    #endif
    #ifdef THREE
    #  if 1
    #    error unreachable
    #  else
    #    error unreachable
    #  endif
    #else
    #  pragma STDC FP_CONTRACT OFF
    #endif
    #undef TWO
    enum { TWO = 1 << 1, /* after
       the macro */ SIX = TWO*3, SEVEN };
    #define HIDDEN TWO
    int f(void) { return PICK + LONG_ONE + SEVEN + HIDDEN/* * 100 */; } // "
    """
    program = CProgram.from_text(text)
    assert program.enumerators == {"TWO": 2, "SIX": 6, "SEVEN": 7}
    # FOUR speaks of TWO when it is used: by then, the enumerator.
    assert program.call("f") == 10 + 1 + 4 + 7 + 2


def test_macros_with_parameters() -> None:
    text = """
    #define LANES 4
    #define PADDED(n) (((n) + LANES - 1) / LANES * LANES)
    #define SUM(a, b) ((a) + (b))
    #define NOTHING() 7
    #define PADDED_SUM(a, b) PADDED(SUM(a, b))
    int PADDED_length(void)
    {
        int PADDED = 1;
        double x[PADDED(5)];
        _Pragma("GCC unroll 1")
        for (int i = 0; i < PADDED(SUM(1, (2, 3))); ++i) {
            x[i] = 1.0;
        }
        x[0] = 2.0;
        return PADDED_SUM(4, 5) + PADDED + NOTHING();
    }
    """
    assert CProgram.from_text(text).call("PADDED_length") == 12 + 1 + 7


def test_macros_can_be_defined_beforehand() -> None:
    text = """
    #ifdef LIBRARY
    double f(double x) { return sin(x)*FACTOR; }
    #else
    double f(double x) { return x; }
    #endif
    """
    angle = Angle("3/5", "4/5")
    assert CProgram.from_text(text).call("f", angle) is angle
    assert CProgram.from_text(text, macros={"LIBRARY": "", "FACTOR": "5.0"}).call("f", angle) == 4
