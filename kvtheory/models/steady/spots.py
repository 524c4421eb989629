"""The input of methods for a ball, from the values of its scene."""

from collections.abc import Mapping
from typing import Any

import numpy as np


def stretch_of(values: Mapping[str, Any]) -> Any:
    """Return sqrt(R'/R), the ratio of width to length of the contact at rest.

    >>> float(stretch_of({"indenter.radius": 0.01, "indenter.radius_across": 0.04}))
    2.0
    """
    along = values["indenter.radius"]
    return np.sqrt(values.get("indenter.radius_across", along) / along)
