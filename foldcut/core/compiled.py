"""When compiled code does the work: an explicit setting, never what happens to be loaded.

A few loops exist twice, in numpy and compiled with numba. Loading the compiled code takes about 0.3 s of processor
time, so a process that folds one drawing loads it only where it saves more than that. A process that folds many
drawings calls ``expect_many_drawings()`` once, at its start. The setting changes how long folding takes, not the
result.

A module may also be written once and run in both ways: its functions are marked with ``compiled_in(__name__)``, which
leaves them as they are, and ``compiled_copy`` loads the same file a second time, compiled. What was compiled is kept in
numba's cache; where that cannot be written, it is compiled in each process.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, wraps
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

from foldcut.core.signals import signals_wait

__all__ = [
    "COMPILED",
    "CompiledCode",
    "compiled_copy",
    "compiled_in",
    "compiler",
    "copy_of",
    "expect_many_drawings",
    "forget_unreadable",
    "is_ready",
]

Function = TypeVar("Function", bound=Callable[..., Any])

COPY = "_compiled"
"""What the name of a module's compiled copy ends in."""


@dataclass
class CompiledCode:
    """Which sizes compiled code is used for."""

    many_drawings: bool = False
    """Whether this process folds many drawings, so that the time for loading compiled code does not matter."""

    def pays(self, size: int, with_loading: int, once_loaded: int = 0) -> bool:
        """Tell whether to use compiled code for a task of this ``size``.

        ``with_loading``: the least size at which it saves more time than loading it takes; ``once_loaded``: the least
        size at which it is faster, loading aside.
        """
        return size >= (once_loaded if self.many_drawings else with_loading)


COMPILED = CompiledCode()
"""The setting of this process."""


def expect_many_drawings() -> None:
    """Use compiled code from now on wherever it is faster: for processes that fold one drawing after the other."""
    COMPILED.many_drawings = True


def compiled_in(module: str, *, inline: bool = False) -> Callable[[Function], Function]:
    """Return the decorator of a module's functions: it compiles them in a compiled copy, and elsewhere does nothing.

    ``module`` is the module's ``__name__``; ``inline`` for small functions that are called very often.
    """
    if not module.endswith(COPY):
        return lambda function: function
    # _nrt: without counting references, which took nine tenths of the time; so nothing may be allocated in there
    options = {"nogil": True, "error_model": "numpy", "forceinline": inline, "_nrt": False}
    compile_later: Callable[[Function], Function] = compiler()(**options)

    def decorate(function: Function) -> Function:
        compiled: Any = compile_later(function)
        with suppress(RuntimeError):  # there is no folder where numba may keep it
            compiled._cache = _kept()(function)
        decorated: Function = compiled
        return decorated

    return decorate


@cache
def compiler() -> Any:
    """Return numba's ``njit``; from then on signals wait while machine code is made or loaded.

    LLVM calls back into Python there, and an exception in such a call, as Ctrl-C raises it, ends the process with a
    segmentation fault.
    """
    from numba import njit
    from numba.core.codegen import JitEngine

    for name in ("finalize_object", "get_function_address", "get_global_value_address"):
        setattr(JitEngine, name, _undisturbed(getattr(JitEngine, name)))
    return njit


def _undisturbed(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function so that signals wait while it runs."""

    @wraps(function)
    def run(*arguments: Any) -> Any:
        with signals_wait():
            return function(*arguments)

    return run


@cache
def _kept() -> type:
    """Return the class of numba's cache of a function, in which what is found is used at once.

    Numba's own first gets everything ready that is needed to compile, which takes most of the time; compiling does
    that, too. That something cannot be written is no error.
    """
    from numba.core.caching import FunctionCache

    class Kept(FunctionCache):  # type: ignore[misc]
        def load_overload(self, sig: Any, target_context: Any) -> Any:
            with suppress(OSError):
                return self._load_overload(sig, target_context)
            return None

        def save_overload(self, sig: Any, data: Any) -> None:
            with suppress(OSError):
                self._save_overload(sig, data)

    return Kept


@cache
def compiled_copy(module: ModuleType) -> ModuleType:
    """Return a second copy of a module, whose marked functions are compiled.

    What was compiled in an earlier process is read from numba's cache.
    """
    return copy_of(module, COPY)


def copy_of(module: ModuleType, suffix: str) -> ModuleType:
    """Load a module's file once more, under its name with a suffix."""
    name = module.__name__ + suffix
    spec = spec_from_file_location(name, module.__file__)
    assert spec is not None
    assert spec.loader is not None
    copy = module_from_spec(spec)
    sys.modules[name] = copy
    spec.loader.exec_module(copy)
    return copy


def is_ready(function: Any) -> bool:
    """Tell whether a compiled function is in numba's cache for this machine, so that nobody waits for the compiler."""
    if function.signatures:
        return True
    kept = function._cache  # numba has no public way to ask
    try:
        known = kept._cache_file._load_index()
        return any(key[1:] == kept._index_key(key[0], function.targetctx.codegen())[1:] for key in known)
    except Exception:  # what an earlier version has left may not be readable
        return False


def forget_unreadable(module: ModuleType) -> None:
    """Remove what an earlier version has left in numba's cache for a compiled copy, if it cannot be read any more."""
    for function in vars(module).values():
        if hasattr(function, "signatures"):
            file: Any = getattr(function._cache, "_cache_file", None)  # None where nothing can be kept
            if file is None:
                continue
            try:
                file._load_index()
            except Exception:
                Path(file._index_path).unlink(missing_ok=True)
