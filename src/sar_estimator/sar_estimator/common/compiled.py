"""Functions compiled to machine code, where profiles say that Python's own pace is what costs.

They are compiled for the types named, when their module is imported, never in flight; what comes
of it is kept beside the module (``__pycache__``), or in the user's cache where that cannot be
written to.

With ``SAR_COMPILE=0`` in the environment they stay plain Python: slower, and some 60 MB less of
memory, for a process that calls them seldom.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(*signatures: str) -> Callable[[Function], Function]:
    """Return a decorator that compiles a function for these signatures of numba's.

    Raises numba's ``TypingError`` at import where the function does not fit them. A compiled
    function takes arguments by position only.
    """

    def compile_it(function: Function) -> Function:
        if os.environ.get("SAR_COMPILE") == "0":
            return function
        numba = importlib.import_module("numba")
        return cast("Function", numba.njit(list(signatures), cache=True)(function))

    return compile_it
