"""The options of the program at the end of docstrings."""

import inspect
import subprocess
from collections.abc import Callable
from typing import TypeVar

from .program import ProgramError, find_program

Function = TypeVar("Function", bound=Callable)
SECONDS = 20  # the longest wait for a text that takes a fraction of one


class WithOptions(str):
    """A docstring that ends with the options of the program, which is asked for them when the text is shown.

    help(), pydoc and IPython show what inspect.cleandoc makes of a docstring, and expandtabs is its first step.
    """

    def expandtabs(self, tabsize: int = 8) -> str:
        """The whole text, the program's part included."""
        return f"{inspect.cleandoc(str(self))}\n\n{options_text()}".expandtabs(tabsize)


def with_options(function: Function) -> Function:
    """Decorator: the docstring of the function ends with the options of the program."""
    function.__doc__ = WithOptions(function.__doc__ or "")
    return function


def options_text() -> str:
    """What `stickslip -help` prints of parameters and options, or in one sentence why it cannot be asked."""
    try:
        printed = subprocess.run([find_program(), "-help"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                 timeout=SECONDS, check=True).stdout
    except (ProgramError, OSError, subprocess.SubprocessError) as problem:
        return f"The options are those of the program, which could not be asked for them: {problem}."
    begin = max(printed.find("Forms of values"), 0)
    end = printed.find("\nOther:", begin)
    return f"Options of the program; write mu_d=0.5 for -mu_d 0.5:\n\n{printed[begin:end if end >= 0 else None]}"
