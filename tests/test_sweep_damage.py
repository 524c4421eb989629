"""A finished file is held against what it should contain; what was lost is told, and computed on request."""

import itertools
import random

import numpy as np
import pytest

import kvtheory as kv
from tests.sweep_driver import kept

V, TAU = "drive.velocity", "foundation.retardation_time"
OVER = {V: "1 mm/s:10 m/s:40:log", TAU: ["50 ms", "0.2 s", "1 s"]}
TEXTS = {"over": {V: [0.05, 0.1, 20.0]}, "quantities": "events"}


def run(path, **more):
    return kv.sweep(output=path, **{"over": OVER, **more})


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of both kinds of files."""
    place = tmp_path_factory.mktemp("whole")
    for suffix in (".csv", ".nc"):
        run(place / f"map{suffix}")
    return {suffix: (place / f"map{suffix}").read_bytes() for suffix in (".csv", ".nc")}


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_a_file_that_lost_or_changed_anything_is_never_taken_for_whole(tmp_path, suffix, whole):
    path, content, chance = tmp_path / f"map{suffix}", whole[suffix], random.Random(1)
    ends = [*np.linspace(1, len(content) - 1, 25).astype(int), len(content) - 1]
    damaged = [content[:end] for end in ends]
    if suffix == ".csv":  # of HDF5, the bytes between the arrays say nothing
        lines = content.splitlines(keepends=True)
        damaged += [b"".join(lines[:n] + lines[n + 1 :]) for n in range(3, len(lines), 7)]
        damaged += [b"".join([*lines[:n], *lines[n - 1 :]]) for n in range(12, len(lines), 17)]
        for _ in range(50):
            at = chance.randrange(len(content))
            damaged.append(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    for spoilt in damaged:
        path.write_bytes(spoilt)
        with pytest.raises(ValueError, match=r"map\.(csv|nc)") as error:
            run(path)
        assert "overwrite" in str(error.value)
        assert path.read_bytes() == spoilt
    run(path, overwrite=True)
    assert path.read_bytes() == content if suffix == ".csv" else run(path)["load"].all()
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


def test_the_rows_that_are_missing_are_counted(tmp_path, whole):
    path = tmp_path / "map.csv"
    lines = whole[".csv"].splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:-7]))
    with pytest.raises(ValueError, match="7 of its 120 rows are missing"):
        run(path)


def test_a_number_that_was_changed_in_netcdf_is_seen(tmp_path):
    import netCDF4

    path = tmp_path / "map.nc"
    run(path)
    with netCDF4.Dataset(path, "a") as data:
        data["depth"][17, 1] *= 1.0 + 1e-15
    with pytest.raises(ValueError, match="depth was changed"):
        run(path)


def test_overwriting_computes_anew_what_is_another_sweep_or_no_sweep(tmp_path):
    path = tmp_path / "map.csv"
    path.write_text("time [s],depth [m]\n0,1\n")
    before = run(path, overwrite=True)
    assert before.computed == 120
    assert run(path).computed == 0
    changed = run(path, over={V: [0.1, 0.2]}, overwrite=True)
    assert (changed.points, changed.computed) == (2, 2)
    assert run(path, over={V: [0.1, 0.2]}, overwrite=True).computed == 2


def test_overwriting_forgets_the_unfinished_work_of_another_sweep_only(tmp_path):
    path = tmp_path / "map.csv"

    def stop(share, words):
        if " a second" in words:
            raise OSError("enough")

    for _ in range(2):
        with pytest.raises(OSError, match="enough"):
            run(path, block=30, progress=stop)
    assert kept(path) == 60
    assert run(path, over={V: [0.1, 0.2]}, overwrite=True).computed == 2
    with pytest.raises(OSError, match="enough"):
        run(path, block=30, progress=stop, overwrite=True)
    assert run(path, overwrite=True).computed == 90


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_texts_alone_are_a_sweep(tmp_path, suffix):
    held = kv.sweep(**TEXTS)
    stored = kv.sweep(output=tmp_path / f"a{suffix}", block=2, **TEXTS)
    assert stored["events"].tolist() == held["events"].tolist()
    assert kv.sweep(output=tmp_path / f"a{suffix}", **TEXTS).computed == 0
    held.save(tmp_path / f"b{suffix}")
    assert kv.sweep(output=tmp_path / f"b{suffix}", **TEXTS).computed == 0


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_every_mixture_of_columns_goes_through_every_store(tmp_path, suffix):
    """Numbers, series and texts, one alone or together, from a resumed run or from one."""
    kinds = {"steady": "load", "series": "depth", "measure": "hops", "text": "events"}
    chosen = [c for n in (1, 2, 4) for c in itertools.combinations(kinds, n)]
    for number, names in enumerate(chosen):
        asked = {"over": {V: [0.05, 0.1, 20.0]}, "quantities": [kinds[name] for name in names]}
        asked |= {"at": "0 ms:200 ms:3"} if "series" in names else {}
        held = kv.sweep(**asked, rtol=1e-4)
        path = tmp_path / f"{number}{suffix}"

        def stop(share, words):
            if share:
                raise OSError("enough")

        with pytest.raises(OSError, match="enough"):
            kv.sweep(output=path, block=1, progress=stop, rtol=1e-4, **asked)
        stored = kv.sweep(output=path, rtol=1e-4, **asked)
        assert stored.computed == 2
        assert kv.sweep(output=path, rtol=1e-4, **asked).computed == 0
        for name in held.values:
            assert stored[name].shape == held[name].shape
            assert stored[name].tolist() == held[name].tolist()


def test_what_cannot_fit_is_refused_with_its_size_before_anything_is_done(tmp_path):
    many = "1 mm/s:1 m/s:10000000"
    over = {V: many, TAU: "1 ms:1 s:10000000", "support.mass": "1 kg/m:2 kg/m:100"}
    for output in (None, tmp_path / "map.csv", tmp_path / "map.nc"):
        with pytest.raises(ValueError, match=r"10,000,000,000,000,000 points need .* years; there"):
            kv.sweep(over=over, output=output)
    assert not list(tmp_path.iterdir())
