"""`python -m krhpr` is the command line."""

import sys

from krhpr.cli import main

if __name__ == "__main__":
    sys.exit(main())
