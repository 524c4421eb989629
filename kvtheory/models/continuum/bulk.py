"""The one entry point for every task of the kernels, to solve many transients in one call among them."""

from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum import deviation as d_
from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum import maxima as m_
from kvtheory.models.continuum.run import DONE, Run
from kvtheory.models.continuum.stepping import TAKE_OFF, walk
from kvtheory.records import record


class Scenes(NamedTuple):
    """Scenes in scaled form, one entry each: inertia and support number, end time, steady friction force.

    A row of `start` holds d and d' at s = 0. The pieces of the drive of scene i are
    `pieces[first[i] : first[i + 1]]`.
    """

    eps: Any
    kappa: Any
    end: Any
    friction: Any
    start: Any
    first: Any
    pieces: Any


class Request(NamedTuple):
    """What to measure beside the extremes of the results: states at scaled times.

    `times` has a row for each scene. A motion is settled if friction stays within `share` of the steady one.
    """

    times: Any
    share: float


class Workspace(NamedTuple):
    """Buffers for sample times, natural times, their states, and two more states; reused for each scene."""

    times: Any
    samples: Any
    natural: Any
    states: Any
    rows: Any


class Results(NamedTuple):
    """Status of both runs, deviations, extremes, states at the times and at the end, by scene."""

    status: Any
    other: Any
    deviations: Any
    largest: Any
    states: Any
    settled: Any
    take_offs: Any
    last: Any


class Bulk(NamedTuple):
    """Everything that the task `FOLLOW` needs besides two runs."""

    scenes: Scenes
    request: Request
    workspace: Workspace
    results: Results


SETTLING = record(force="f8", share="f8", time="f8")
"""When friction stays within a share of a force."""
WALK, STATES, NATURAL, DEVIATIONS, SAMPLE, LARGEST, SETTLED, FOLLOW = range(8)
"""Tasks of `perform`."""


def perform(  # noqa: PLR0912  # a branch for each task
    task: int, first: Run, second: Run, times: Any, states: Any, rows: Any, worst: Any, extremes: Any,
    settling: Any, count: int, bulk: Bulk,
) -> int:  # fmt: skip
    """Perform a task: the only entry to the kernels, so that each of them is compiled once.

    Arguments that a task does not need are blank. The last task is to
    solve the scenes of `bulk` by the methods of both runs, in at most `count` steps each, and to measure the
    solutions; the status of a scene tells if it did not reach its end, or ran out of room. It stands here
    because numba would generate the code of all kernels once more for a function of its own.
    """
    one = Run(first.given[0], first.method[0], first.now[0], *first[3:])
    two = Run(second.given[0], second.method[0], second.now[0], *second[3:])
    if task == WALK:
        return walk(one, count)
    if task == STATES:
        e_.states(times, states, one)
    elif task == NATURAL:
        return e_.natural(one, times, states)
    elif task == DEVIATIONS:
        d_.deviations(times, states, one, two, rows, worst[0])
    elif task == SAMPLE:
        return m_.sample(one, times, states)
    elif task == LARGEST:
        for i in range(len(extremes)):
            m_.find(one, times, states, count, extremes[i], rows[0])
    elif task == SETTLED:
        asked = settling[0]
        asked.time = m_.settled(one, times, states, count, asked.force, asked.share, rows[0])
    if task != FOLLOW:
        return 0

    scenes, request, room, results = bulk.scenes, bulk.request, bulk.workspace, bulk.results
    for i in range(len(scenes.eps)):
        pieces = scenes.pieces[scenes.first[i] : scenes.first[i + 1]]
        one, two = Run(*one[:3], pieces, *one[4:]), Run(*two[:3], pieces, *two[4:])
        for run in (one, two):
            run.given.eps, run.given.kappa = scenes.eps[i], scenes.kappa[i]
            run.given.end, run.now.nodes = scenes.end[i], 0
            run.given.start_depth, run.given.start_rate = scenes.start[i, 0], scenes.start[i, 1]
        results.status[i] = walk(one, count)
        if results.status[i] != DONE:
            continue
        results.other[i] = walk(two, count)
        if results.other[i] == DONE:
            found = e_.natural(one, room.natural, room.states)
            natural, of_them = room.natural[:found], room.states[:found]
            d_.deviations(natural, of_them, one, two, room.rows, results.deviations[i])
        times, states, row = room.times, room.samples, room.rows[0]
        found = m_.sample(one, times, states)
        for k in range(len(results.largest[i])):
            m_.find(one, times, states, found, results.largest[i][k], row)
        results.settled[i] = m_.settled(
            one, times, states, found, scenes.friction[i], request.share, row
        )
        e_.states(request.times[i], results.states[i], one)
        e_.state_at(one, one.now.steps - 1, one.now.s, results.last[i])
        for k in range(one.now.events):
            if one.events[k].kind == TAKE_OFF:
                results.take_offs[i] += 1
    return 0


_ROW, _ROWS, _COUNTS = np.zeros(0), np.zeros((0, 0)), np.zeros(0, dtype=np.int64)
_STATES = np.zeros(0, e_.STATE)
NO_BULK = Bulk(
    Scenes(_ROW, _ROW, _ROW, _ROW, _ROWS, _COUNTS, _ROWS),
    Request(_ROWS, 0.0),
    Workspace(_ROW, _STATES, _ROW, _STATES, _STATES),
    Results(
        _COUNTS, _COUNTS, np.zeros(0, d_.DEVIATION), np.zeros((0, 0), m_.EXTREME),
        np.zeros((0, 0), e_.STATE), _ROW, _COUNTS, _STATES,
    ),
)  # fmt: skip
"""Placeholder for the tasks that need no scenes."""
