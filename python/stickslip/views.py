"""Pictures and tables of data.

Modules that make a view of a class register it here, and the methods of that class ask for it by name: data import no
pictures, and neither matplotlib nor pandas is loaded before a view is wanted."""

import importlib
from collections.abc import Callable
from typing import Any

# Modules that register views.
_MAKERS = {"picture": (".plots", ".plots.chains", ".plots.fits"), "table": (".frames",), "dataset": (".frames",)}
_VIEWS: dict[tuple[str, type], Callable[..., Any]] = {}


def view(name: str, of: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Registers a function of an object of that class."""
    def register(made: Callable[..., Any]) -> Callable[..., Any]:
        _VIEWS[name, of] = made
        return made
    return register


def viewed(name: str, data: Any, *arguments: Any, **look: Any) -> Any:
    """What the function registered for the class of the data, or for the nearest it derives from, makes of it."""
    for maker in _MAKERS[name]:
        importlib.import_module(maker, __package__)
    kind = next(kind for kind in type(data).__mro__ if (name, kind) in _VIEWS)
    return _VIEWS[name, kind](data, *arguments, **look)
