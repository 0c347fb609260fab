"""Printers: graphs as named lines of one language."""
