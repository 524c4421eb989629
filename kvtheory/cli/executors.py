"""Executors of sweeps by the name of what makes them."""

import importlib
from concurrent.futures import Executor

from kvtheory.scene.quantities import nearest


def from_factory(text: str, jobs: int | None) -> Executor:
    """Call the factory ``module:name``, with the number of jobs if one is given.

    Raises
    ------
    ValueError
        If there is no such module or name, or it does not give an executor.

    Examples
    --------
    >>> with from_factory("concurrent.futures:ThreadPoolExecutor", 2) as executor:
    ...     executor.submit(abs, -2).result()
    2
    """
    given = f'--executor "{text}"'
    name, sign, factory = text.partition(":")
    if not (name and sign and factory):
        raise ValueError(
            f"{given}: expected module:factory, such as concurrent.futures:ThreadPoolExecutor"
        )
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:  # whatever the module does when it is run
        raise ValueError(f"{given}: the module cannot be imported: {_told(error)}") from None
    if not hasattr(module, factory):
        names = [known for known in dir(module) if not known.startswith("_")]
        raise ValueError(f"{given}: {nearest(factory, names)}")
    try:
        executor = getattr(module, factory)(*([] if jobs is None else [jobs]))
    except (Exception, SystemExit) as error:
        raise ValueError(f"{given}: the factory cannot be called: {_told(error)}") from None
    if not isinstance(executor, Executor) or type(executor) is Executor:
        raise ValueError(f"{given}: expected a concurrent.futures.Executor, got {executor!r}")
    return executor


def _told(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"
