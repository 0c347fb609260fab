"""From a file, or an installed entry point, to a checked `Plugin`."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterable
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType

from krhpr.derivations.plugin import Plugin
from krhpr.errors import PluginError
from krhpr.plugins.checking import check
from krhpr.plugins.traces import told

GROUP = "krhpr.sublegs"
"""The group of entry points that name a `Plugin`."""

NAME = "PLUGIN"
"""What a plugin's file calls it."""


def load_plugins(paths: Iterable[Path]) -> list[Plugin]:
    """The plugins of these files and the installed ones, all different."""
    found: dict[str, str] = {}
    plugins = []
    named = [(str(path), load_plugin(path)) for path in paths]
    installed = [(f"the entry point {name}", plugin) for name, plugin in installed_plugins()]
    for source, plugin in (*named, *installed):
        name = plugin.subleg.name
        if name in found:
            raise PluginError(
                f"{source}: the sub-leg is called {name!r}, as that of {found[name]}; rename one of them"
            )
        found[name] = source
        plugins.append(plugin)
    return plugins


def load_plugin(path: Path) -> Plugin:
    """The `PLUGIN` of a Python file, which is run.

    Raises PluginError: the file is missing or fails, has no `PLUGIN`, or `PLUGIN` is not right (`check`).
    """
    if not path.is_file():
        raise PluginError(
            f"{path}: there is no such file; --plugin takes a Python file that states a sub-leg"
        )
    module = _run(path)
    if not hasattr(module, NAME):
        raise PluginError(
            f"{path}: nothing is called {NAME}; end the file with `{NAME} = Plugin(YourSubLeg(), sizes=...)`"
        )
    return check(getattr(module, NAME), str(path))


def installed_plugins() -> list[tuple[str, Plugin]]:
    """The plugins that installed packages offer, with the names of their entry points."""
    return [(point.name, _installed(point)) for point in entry_points(group=GROUP)]


def _installed(point: EntryPoint) -> Plugin:
    source = f"the entry point {point.name} = {point.value}"
    try:
        found = point.load()
    except Exception as error:
        raise PluginError(f"{source}: it cannot be loaded: {type(error).__name__}: {error}") from error
    return check(found, source)


def _run(path: Path) -> ModuleType:
    name = f"krhpr_plugin_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"{path}: not a Python file; its name must end in .py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses and pickle look modules up by name
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise PluginError(told(error, str(path), "")) from error
    return module
