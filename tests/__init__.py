"""The tests; `KVTHEORY_TEST_SCENES=1000` in the environment draws five times as many random scenes."""

import os

SCENES = int(os.environ.get("KVTHEORY_TEST_SCENES", "200"))
