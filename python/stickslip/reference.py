"""What the program says of its options: at the end of docstrings, and to pictures and the explorer."""

import functools
import inspect
import json
import keyword
import os
import pathlib
import subprocess
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

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


class OptionsSignature(inspect.Signature):
    """A signature that ends with the options of the program, which is asked for them when they are looked at: IPython
    completes them. help() shows it as it stands in the source."""

    @property
    def parameters(self) -> Mapping[str, inspect.Parameter]:
        """By name."""
        own = super().parameters
        try:
            names = [f"{name}_" if keyword.iskeyword(name) else name for name in declared()]
        except ProgramError:
            names = []
        kind = inspect.Parameter.KEYWORD_ONLY
        options = {name: inspect.Parameter(name, kind, default=None) for name in names if name not in own}
        ends = {name: parameter for name, parameter in own.items() if parameter.kind is inspect.Parameter.VAR_KEYWORD}
        return {**{name: parameter for name, parameter in own.items() if name not in ends}, **options, **ends}

    def format(self, **form: Any) -> str:
        """As in the source."""
        return str(self)

    def __str__(self) -> str:
        return str(inspect.Signature([*super().parameters.values()]))


def with_options(function: Function) -> Function:
    """Decorator: docstring and signature of the function end with the options of the program."""
    function.__doc__ = WithOptions(function.__doc__ or "")
    function.__signature__ = OptionsSignature([*inspect.signature(function).parameters.values()])  # type: ignore[attr-defined]
    return function


def declared(program: str | os.PathLike[str] | None = None) -> Mapping[str, Mapping[str, Any]]:
    """Options of the program, by default that of `find_program`, by name, each as -reference_json prints it.

    Raises
    ------
    ProgramError
        If there is no program that can be asked.
    """
    return _asked(program)["options"]


def keys(program: str | os.PathLike[str] | None = None) -> Mapping[str, tuple[str, str]]:
    """Keys of results of the program, by default that of `find_program`.

    Each has its quantity and the option that it is an array over, empty for a scalar.

    Raises
    ------
    ProgramError
        If there is no program that can be asked.
    """
    return _asked(program)["keys"]


def _asked(program: str | os.PathLike[str] | None) -> Mapping[str, Mapping[str, Any]]:
    found = _declared(pathlib.Path(program) if program else find_program())
    if isinstance(found, ProgramError):
        raise found
    return found


@functools.lru_cache
def _declared(program: pathlib.Path) -> Mapping[str, Mapping[str, Any]] | ProgramError:
    """A failure is kept as well: pictures ask for every symbol, and each answer would take a process."""
    try:
        tree = json.loads(_printed(program, "-reference_json"))
        return {"options": {option["name"]: option for option in tree["options"]},
                "keys": {key: (quantity["word"], over) for quantity in tree.get("quantities", [])
                         for key, over in quantity["keys"].items()}}
    except ProgramError as problem:
        return problem
    except ValueError:
        return ProgramError(f"{program} does not say what its options are")


def _printed(program: pathlib.Path, word: str) -> str:
    try:
        return subprocess.run([program, word], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=SECONDS, check=True).stdout
    except (OSError, subprocess.SubprocessError) as problem:
        raise ProgramError(str(problem)) from None


def options_text() -> str:
    """What `stickslip -help` prints of parameters and options, or in one sentence why it cannot be asked."""
    try:
        printed = _printed(find_program(), "-help")
    except ProgramError as problem:
        return f"The options are those of the program, which could not be asked for them: {problem}."
    begin = max(printed.find("Forms of values"), 0)
    end = printed.find("\nOther:", begin)
    return f"Options of the program; write mu_d=0.5 for -mu_d 0.5:\n\n{printed[begin:end if end >= 0 else None]}"
