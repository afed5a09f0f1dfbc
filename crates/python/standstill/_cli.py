"""The program ``standstill``, as the wheel installs it."""

import signal
import sys
from typing import NoReturn

from standstill import _native


def main() -> NoReturn:
    """Runs the command line with the arguments of the process, and ends it with its status."""
    # The command line does not return to Python before it is done, so nobody would look at what Python notes of a Ctrl-C.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_native.main(sys.argv[1:]))
