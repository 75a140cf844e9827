"""When compiled code does the work: an explicit setting, never what happens to be loaded.

A few loops exist twice, in numpy and compiled with numba (extra ``fast``). Loading the compiled code takes about 0.4 s
of processor time, so a process that folds one drawing loads it only where it saves more than that. A process that folds
many drawings calls ``expect_many_drawings()`` once, at its start. The setting changes how long folding takes, not the
result.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["COMPILED", "CompiledCode", "expect_many_drawings"]


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
