"""What a measured chart was made with: machine and versions."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = "kvtheory", "numpy", "scipy", "numba", "scikit-sundae"


def environment() -> dict[str, str | int]:
    """Return machine, processors, and versions; a package that is not installed is ``"-"``.

    Examples
    --------
    >>> sorted(environment())[:3]
    ['kvtheory', 'machine', 'numba']
    """
    return {
        "machine": platform.machine(),
        "system": platform.system(),
        "processor": _processor(),
        "processors": os.cpu_count() or 1,
        "python": platform.python_version(),
        **{name: _version(name) for name in PACKAGES},
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "-"


def _processor() -> str:
    """Return the name of the processor, where the system tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            for line in file:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor()
