"""Sub-legs of one's own: read from a file or an entry point, checked, and made into robots.

    plugins = load_plugins([Path("offset_wrist.py")])
    entries = [entry for plugin in plugins for entry in plugin.entries()]

Loading runs the author's code: a plugin is named on the command line or installed as an entry point, never
by a robot file.
"""

from krhpr.plugins.checking import check
from krhpr.plugins.loading import GROUP, installed_plugins, load_plugin, load_plugins
from krhpr.plugins.printed import Printed
from krhpr.plugins.proving import prove

__all__ = ["GROUP", "Printed", "check", "installed_plugins", "load_plugin", "load_plugins", "prove"]
