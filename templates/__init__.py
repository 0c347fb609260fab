"""Layouts of the output files (Jinja2), one folder per target."""
