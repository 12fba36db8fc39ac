"""What goes wrong, in the three kinds that the program's exit codes tell apart."""


class InputError(ValueError):
    """Input that cannot be used; nothing was written. The text says file, place, value, allowed range and remedy."""


class IoError(OSError):
    """A file that cannot be read or written, although its name and content were acceptable."""


class RunFailed(RuntimeError):
    """A run that started well could not go on. The last good state is there, in the result or in the simulation.

    tick: of the haptic tick that could not be made, from 1 · stage: "contact", "water", "solid" … · element: number of
    the tet, vertex or triangle, −1: none in particular · quantity, value, bound: what was out of its bound
    """

    def __init__(self, message, tick, stage, element, quantity, value, bound):
        super().__init__(message)
        self.tick, self.stage, self.element = tick, stage, element
        self.quantity, self.value, self.bound = quantity, value, bound


for kind in (InputError, IoError, RunFailed):
    kind.__module__ = "argil"  # as which a traceback names them
