"""Targets: one module for each kind of output; layouts are in `templates/`."""
