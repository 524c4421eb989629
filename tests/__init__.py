"""The tests; `KVTHEORY_TEST_SCENES=1000` in the environment draws five times as many random scenes."""

import os
import tomllib
from pathlib import Path

SCENES = int(os.environ.get("KVTHEORY_TEST_SCENES", "200"))
SUPPORTS = "fixed", "dead-weight", "suspended"
REFUSALS = tomllib.loads((Path(__file__).parent / "data" / "refusals.toml").read_text("utf-8"))
"""Wrong input, and words of the message that it costs."""
