"""Many transients in one call of a kernel: each is followed, compared, and measured, in the same room."""

from typing import Any, NamedTuple

from kvtheory.models.continuum import deviation as d_
from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum import maxima as m_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.run import Given, Run, rest
from kvtheory.models.continuum.stepping import DONE, TAKE_OFF, walk


class Scenes(NamedTuple):
    """Scenes in scaled form, an entry for each: inertia and support number, end, steady friction force.

    The pieces of the drive of scene i are `pieces[first[i] : first[i + 1]]`.
    """

    eps: Any
    kappa: Any
    end: Any
    friction: Any
    first: Any
    pieces: Any


class Asked(NamedTuple):
    """What is measured of each: the largest of columns in a sense (see `maxima`), the states at times.

    Each scene has a row of scaled `times`; settled is what stays within a `share` of the steady friction.
    """

    columns: Any
    senses: Any
    times: Any
    share: float


class Room(NamedTuple):
    """What is overwritten by each scene: the samples, the natural times with their states, and two states."""

    times: Any
    samples: Any
    natural: Any
    states: Any
    rows: Any


class Found(NamedTuple):
    """The outcome: how the walks ended, deviations, largest values with their times, and the rest.

    `last` holds the state at the end, the leading and the trailing edge behind it.
    """

    status: Any
    other: Any
    deviations: Any
    largest: Any
    states: Any
    settled: Any
    take_offs: Any
    last: Any


def follow(
    scenes: Scenes, fine: Run, other: Run, asked: Asked, room: Room, found: Found, steps: int
) -> None:
    """Follow the scenes; `fine` and `other` hold the two methods and room for a motion each.

    A scene that is not followed to its end, be it for want of room, leaves its status.
    """
    for i in range(len(scenes.eps)):
        one, two = _begun(fine, scenes, i), _begun(other, scenes, i)
        found.status[i] = walk(one, steps)
        if found.status[i] != DONE:
            continue
        found.other[i] = walk(two, steps)
        if found.other[i] == DONE:
            count = e_.natural(one, room.natural, room.states)
            times, states = room.natural[:count], room.states[:count]
            d_.deviations(times, states, one, two, room.rows, found.deviations[i])
        _measure(one, i, scenes.friction[i], asked, room, found)


def _begun(run: Run, scenes: Scenes, i: int) -> Run:
    g, pieces = run.given, scenes.pieces[scenes.first[i] : scenes.first[i + 1]]
    given = Given(
        scenes.eps[i], scenes.kappa[i], scenes.end[i],
        g.fixed, g.rtol, g.allowed, g.control, g.method,
        g.eps_x, g.damping, g.spring, g.sprung, g.drives,
    )  # fmt: skip
    begun = Run(
        given, pieces, run.now, run.counts, run.states, run.tops, run.edges,
        run.records, run.nodes, run.events, run.matrix, run.along,
    )  # fmt: skip
    rest(begun)
    return begun


def _measure(run: Run, i: int, friction: float, asked: Asked, room: Room, found: Found) -> None:
    count = m_.sample(run, room.times, room.samples)
    for k in range(len(asked.columns)):
        found.largest[i][k][0], found.largest[i][k][1] = m_.largest(
            run, room.times, room.samples, count, asked.columns[k], asked.senses[k], room.rows[0]
        )
    found.settled[i] = m_.settled(
        run, room.times, room.samples, count, friction, asked.share, room.rows[0]
    )
    e_.states(asked.times[i], found.states[i], run)
    m_.last(room.samples, count, found.last[i])
    for k in range(run.counts[r_.EVENTS]):
        if run.events[k][1] == TAKE_OFF:
            found.take_offs[i] += 1
