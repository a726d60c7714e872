"""``python -m polyfold`` is the ``polyfold`` command."""

import sys

from polyfold.cli import main

sys.exit(main())
