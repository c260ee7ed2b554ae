"""Modules of other projects; where one is missing, the error says how to install it."""

import importlib
from types import ModuleType

COMMANDS = {name: f"pip install {name}, or on Debian apt-get install python3-{name}"
            for name in ("numpy", "h5py", "matplotlib", "tornado", "scipy", "pandas", "xarray")}
COMMANDS["tkinter"] = "on Debian apt-get install python3-tk"  # a part of Python, which pip does not have
COMMANDS["obspy"] = "pip install obspy"


def needed(name: str) -> ModuleType:
    """Import a module of another project.

    Parameters
    ----------
    name
        Its name, perhaps with dots.

    Returns
    -------
    module

    Raises
    ------
    ImportError
        In one sentence that names the commands of pip and apt.
    """
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        top = name.partition(".")[0]
        if isinstance(problem, ModuleNotFoundError) and (problem.name or "").partition(".")[0] == top:
            raise ImportError(f"stickslip needs {top} for this: {COMMANDS[top]}") from None
        raise
