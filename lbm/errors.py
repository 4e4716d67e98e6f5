"""What can be wrong with a user's input or a run, each said so that it can be mended."""

from __future__ import annotations

__all__ = ["DivergenceError", "InputError", "OutputError", "OutsideRangeWarning"]


class InputError(ValueError):
    """The input cannot be used; the message names what is wrong and what to do."""


class DivergenceError(RuntimeError):
    """The flow left the range in which the method holds: NaN, density or speed out of range.

    ``step``, ``cell`` (x, y, z), ``quantity`` and ``value`` say where it was found.
    """

    def __init__(self, step: int, cell: tuple[int, int, int], quantity: str, value: float, hint: str = ""):
        self.step, self.cell, self.quantity, self.value = step, cell, quantity, value
        where = ", ".join(str(i) for i in cell)
        super().__init__(f"diverged by step {step} at cell ({where}): {quantity} = {value:g}{hint}")


class OutsideRangeWarning(UserWarning):
    """The parameters are usable, but outside the range in which the method is accurate."""


class OutputError(OSError):
    """A file could not be written; what was there before is intact."""
