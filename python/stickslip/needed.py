"""Modules that Debian ships by themselves; where one is missing, the error names its package."""

import importlib
from types import ModuleType

PACKAGES = {"numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib",
            "tkinter": "python3-tk", "tornado": "python3-tornado"}


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
        In one sentence that names the Debian package.
    """
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        top = name.partition(".")[0]
        if isinstance(problem, ModuleNotFoundError) and problem.name == top:
            raise ImportError(f"stickslip needs {top} for this: apt-get install {PACKAGES[top]}") from None
        raise
