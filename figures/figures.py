"""What `python figures/fig6.py` finds as `figures`: it puts the package in its place.

The path of a script holds its own folder, that of a module the checkout.
"""

import sys
from importlib import import_module
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])
del sys.modules["figures"]
import_module("figures")
