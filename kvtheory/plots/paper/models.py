"""The two models of the paper, of any scene."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from kvtheory.scene import DeadWeight, Fixed, Scene
from kvtheory.scene.capabilities import (
    lacks_one_scene,
    lacks_paper_model,
    lacks_rigid_continuum,
    require,
)
from kvtheory.scene.start import REST
from kvtheory.scene.static_state import StaticState

SUPPORTS = {"fixed": "FI: fixed indenter", "dead-weight": "MI: dead weight"}
WHAT = "a figure of the paper"
Columns = Mapping[str, Any]
"""The data of a figure: columns by their heads."""


def models(scene: Scene | None) -> dict[str, Scene]:
    """Return a scene with a fixed indenter at its static depth, and under its static load; or Table 1.

    >>> [each.support.kind for each in models(Scene.table1("suspended")).values()]
    ['fixed', 'dead-weight']
    """
    if scene is None:
        return {support: Scene.table1(support) for support in SUPPORTS}
    require(lacks_one_scene, scene, WHAT)
    require(lacks_rigid_continuum, scene, WHAT)
    if scene.start != REST:
        raise ValueError(f"{WHAT} begins at rest at the static depth; leave out `start`")
    rest, own = StaticState.of(scene), scene.support
    supports: dict[str, Any] = {
        "fixed": Fixed(depth=rest.depth),
        "dead-weight": DeadWeight(load=rest.load),
    }
    return {
        kind: replace(scene, support=own if own.kind == kind else other)
        for kind, other in supports.items()
    }


def sliding(scene: Scene | None) -> dict[str, Scene]:
    """Return the models where their steady sliding is that of the paper: a parabola on Kelvin-Voigt."""
    if scene is not None:
        require(lacks_paper_model, scene, "steady sliding as in the paper")
    return models(scene)
