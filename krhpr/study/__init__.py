"""Studies of the thesis, run again."""
