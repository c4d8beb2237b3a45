"""Functions compiled to machine code, where profiles say that Python's own pace is what costs.

They are compiled for the types named, when their module is imported, never in flight; what comes
of it is kept beside the module (``__pycache__``), or in the user's cache where that cannot be
written to.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(*signatures: str) -> Callable[[Function], Function]:
    """Return a decorator that compiles a function for these signatures of numba's.

    Raises numba's ``TypingError`` at import where the function does not fit them. A compiled
    function takes arguments by position only.
    """

    def compile_it(function: Function) -> Function:
        return cast("Function", njit(list(signatures) or None, cache=True)(function))

    return compile_it
