"""Writes `kvtheory/layer/model_error.json`: python -m tests.layer_error_table, ten minutes on two cores.

Every entry is the lowest and the highest error, over spectra of the same width and stiffening, of the
foundation against boundary elements of the body.
"""

import json
import math
from concurrent.futures import ProcessPoolExecutor
from itertools import product

import numpy as np
from scipy.optimize import brentq

import kvtheory as kv
from kvtheory.layer.body import Body, Support
from kvtheory.layer.model_error import TABLE, half_width, spectrum
from kvtheory.layer.sliding import levels
from kvtheory.theory.contact_at_rest import load_at_rest

THICKNESS = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0]
"""Over the half length at rest; the last one of a ball is a half-space."""
RATIOS = [0.0, 0.3, 0.45, 0.49, 0.5]
STIFFENING = {"dead-weight": [1.05, 3.0, 50.0, 2000.0], "fixed": [3.0, 20.0, 200.0]}
WIDTHS = {"dead-weight": [0.0, 2.0, 6.0], "fixed": [0.0, 6.0]}
PLACES = np.array([-1.2, -0.6, -0.3, 0.0, 0.3, 0.6, 1.0, 1.5, 2.2])
"""log10(V/V*) over the half width of the transition in decades."""
SLOPES = (-0.5,)
"""Powers of the relaxation time as which the moduli of many arms vary."""
RADIUS, DEPTH, MODULUS = 0.01, 1e-4, 1e6
VOIGT = math.inf, 0.0
HALF_LENGTH = math.sqrt(2.0 * RADIUS * DEPTH)
CELLS = {True: 60, False: 20}
COARSE = 0.02
"""Largest change between the last two grids."""
NAMES = {"dead-weight": "depth", "fixed": "load"}
"""Of the quantity that is wrong beside the friction coefficient."""


def spectra(width):
    """Return arms, of a total modulus of 1, of each form of a spectrum of a width."""
    if width == 0.0:
        return [[(1.0, 0.02)]]
    found = []
    for n, slope in [(2, 0.0)] + [(int(width) + 2, slope) for slope in SLOPES]:

        def arms(decades, n=n, slope=slope):
            times = 0.02 * np.logspace(0.0, decades, n)
            moduli = times**slope
            return list(zip(moduli / np.sum(moduli), times, strict=True))

        decades = brentq(lambda d: spectrum(arms(d))[0] - width, 0.1, 40.0)
        found.append(arms(decades))
    return found


def scene_of(support, kind, thickness, nu, arms):
    """Return a scene of independent elements, and the layer: no arms are Kelvin-Voigt."""
    shape = {"line": kv.Parabola, "ball": kv.Sphere}[kind](radius=RADIUS)
    H = thickness * HALF_LENGTH
    load = float(load_at_rest(DEPTH, RADIUS, MODULUS, H, nu, per_width=shape.per_width))
    of_depth = 4.0 / 3.0 * HALF_LENGTH * DEPTH if shape.per_width else math.pi * RADIUS * DEPTH**2
    K = load / of_depth
    if arms:
        body = Body.of_series(MODULUS, H, nu, [(MODULUS * E, tau) for E, tau in arms])
        foundation = kv.GeneralizedMaxwell(stiffness=K, arms=[(K * E, tau) for E, tau in arms])
    else:
        body = Body.kelvin_voigt(MODULUS, H, nu, 0.02)
        foundation = kv.Foundation(K, 0.02)
    held = kv.Fixed(DEPTH) if support == "fixed" else kv.DeadWeight(load=load)
    return kv.Scene(shape, foundation, held, kv.Drive(1.0)), body


def errors(support, kind, thickness, nu, arms, ratios):
    """Return both errors over V/V*, and the changes from grid to grid."""
    scene, body = scene_of(support, kind, thickness, nu, arms)
    velocities = ratios * float(kv.asymptotes(scene).critical_velocity)
    found = kv.steady(scene, over={"drive.velocity": velocities})
    fine, coarse = np.array([on_the_body(scene, body, V) for V in velocities]).T.reshape(2, 2, -1)
    ours = np.array([getattr(found, name) for name in names(scene)])
    return ours / fine - 1.0, coarse / fine - 1.0


def names(scene):
    """Return the names of both quantities."""
    return "friction_coefficient", NAMES[scene.support.kind]


def on_the_body(scene, body, velocity):
    """Return values on the body, and on the grid before the last, of those on which the pressure is found."""
    known = []
    try:
        for found in levels(scene.indenter, body, velocity, Support.of_scene(scene.support)):
            values = found.values(scene.indenter, body, velocity)
            known.append([values[name] for name in names(scene)])
            touching = np.count_nonzero(found.contact.active.any(axis=1))
            enough = CELLS[scene.indenter.per_width] * (1.0 + 0.1 * HALF_LENGTH / body.thickness)
            if len(known) > 1 and touching > enough:
                break
    except ArithmeticError:
        if len(known) < 2:
            raise
    return [*known[-1], *known[-2]]


def entry(case):
    """Return the lowest and the highest errors of an entry, (4, places)."""
    support, kind, thickness, nu, stiffening, width = case
    ratios = 10.0 ** (PLACES * half_width(width, stiffening))
    if half_space(kind, thickness):
        thickness = math.inf
    if math.isinf(stiffening):
        forms = [[]]  # Kelvin-Voigt
    else:
        forms = [[((stiffening - 1.0) * E, tau) for E, tau in arms] for arms in spectra(width)]
    found = [resolved(*errors(support, kind, thickness, nu, arms, ratios)) for arms in forms]
    return case, np.concatenate([np.min(found, axis=0), np.max(found, axis=0)])


def resolved(found, change):
    """Return errors; where no grid resolves friction at low velocity, those at a higher one."""
    found = np.where(abs(change) < COARSE, found, np.nan)
    for i in reversed(range(found.shape[1] - 1)):
        found[:, i] = np.where(np.isnan(found[:, i]), found[:, i + 1], found[:, i])
    if not np.isfinite(found).all():
        raise AssertionError("no grid is fine enough")
    return found


def cases():
    """Return all entries; of a half-space Poisson's ratio does not matter."""
    for support, kind, h, nu in product(NAMES, ("line", "ball"), THICKNESS, RATIOS):
        if nu == RATIOS[-1] or not half_space(kind, h):
            for stiffening, width in [*product(STIFFENING[support], WIDTHS[support]), VOIGT]:
                yield support, kind, h, nu, stiffening, width


def half_space(kind, thickness):
    """Whether a thickness stands for a half-space."""
    return kind == "ball" and thickness == THICKNESS[-1]


def table(found):
    """Return the map: errors in per mille, by support, kind and law, over its axes."""
    result = {"thickness": THICKNESS, "poisson_ratio": RATIOS, "place": PLACES.tolist()}
    for support in NAMES:
        M, width = STIFFENING[support], WIDTHS[support]
        result[support] = {"stiffening": M, "width": width}
        for kind in ("line", "ball"):
            laws = {"arms": list(product(M, width)), "kelvin_voigt": [VOIGT]}
            for law, pairs in laws.items():
                entries = [
                    found[support, kind, h, RATIOS[-1] if half_space(kind, h) else nu, *pair].T
                    for h, nu, pair in product(THICKNESS, RATIOS, pairs)
                ]
                result[support][f"{kind} {law}"] = (
                    np.rint(1e3 * np.ravel(entries)).astype(int).tolist()
                )
    return result


if __name__ == "__main__":
    with ProcessPoolExecutor(2) as workers:
        TABLE.write_text(
            json.dumps(table(dict(workers.map(entry, cases()))), separators=(",", ":")) + "\n"
        )
