"""A file is held against what it should contain: what was lost or changed in it is noticed."""

import itertools
import json
import random
import sqlite3

import numpy as np
import pytest

import kvtheory as kv
from tests.sweep_driver import kept

V, TAU = "drive.velocity", "foundation.retardation_time"
OVER = {V: "1 mm/s:10 m/s:40:log", TAU: ["50 ms", "0.2 s", "1 s"]}
REFUSED = r"not a sweep as it was written.*overwrite"


def run(path, **more):
    return kv.sweep(output=path, **{"over": OVER, **more})


def stop(share, words):
    """Stop a sweep after its first block."""
    if share:
        raise OSError("enough")


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_a_file_of_which_any_byte_was_lost_or_changed_is_never_taken_for_whole(tmp_path, suffix):
    path, chance = tmp_path / f"map{suffix}", random.Random(1)
    run(path)
    content = path.read_bytes()
    ends = [*np.linspace(1, len(content) - 1, 25).astype(int), len(content) - 1]
    damaged = [b"", content + b"\n", *(content[:end] for end in ends)]
    for at in [0, 100, len(content) - 1, *chance.sample(range(len(content)), 47)]:
        damaged.append(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    for spoilt in damaged:
        path.write_bytes(spoilt)
        with pytest.raises(ValueError, match=REFUSED):
            run(path)
        assert path.read_bytes() == spoilt
    run(path, overwrite=True)
    assert run(path).computed == 0
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


def test_netcdf_that_another_program_altered_or_saved_again_is_refused(tmp_path):
    import netCDF4
    import xarray

    path = tmp_path / "map.nc"
    run(path)
    with xarray.open_dataset(path) as data:
        assert data["load"].shape == (40, 3)
        copy = data.load()
    assert run(path).computed == 0  # it was only read
    with netCDF4.Dataset(path, "a") as data:
        data[TAU].setncattr("units", "ms")
    with pytest.raises(ValueError, match=REFUSED):
        run(path)
    copy.to_netcdf(path)
    with pytest.raises(ValueError, match="saved anew by another program"):
        run(path)


@pytest.mark.parametrize(
    "asked", [{}, {"quantities": ["load", "events"], "over": {V: [0.05, 0.1]}}]
)
def test_a_damaged_block_of_the_work_file_is_noticed(tmp_path, asked):
    path, chance = tmp_path / "map.csv", random.Random(2)
    whole = run(tmp_path / "whole.csv", **asked).path.read_bytes()
    with pytest.raises(OSError, match="enough"):
        run(path, block=1, progress=stop, **asked)
    with sqlite3.connect(f"{path}.part") as base:  # works the log into the file
        base.execute("PRAGMA journal_mode=DELETE")
        assert base.execute("SELECT count(*) FROM blocks").fetchone() == (1,)
    base.close()
    work = path.with_name("map.csv.part")
    content = work.read_bytes()
    used = [at for at, byte in enumerate(content) if byte]
    noticed = 0
    for at in chance.sample(used, 40):
        work.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
        try:
            run(path, **asked)
        except (ValueError, OSError):
            assert not path.exists()
            noticed += 1
        else:  # counters of SQLite, and what is computed again
            assert path.read_bytes() == whole
            path.unlink()
    assert noticed > 20


def test_overwriting_computes_anew_what_is_another_sweep_or_no_sweep(tmp_path):
    path = tmp_path / "map.csv"
    path.write_text("time [s],depth [m]\n0,1\n")
    assert run(path, overwrite=True).computed == 120
    assert run(path).computed == 0
    changed = run(path, over={V: [0.1, 0.2]}, overwrite=True)
    assert (changed.points, changed.computed) == (2, 2)
    assert run(path, over={V: [0.1, 0.2]}, overwrite=True).computed == 2


def test_overwriting_forgets_the_unfinished_work_of_another_sweep_only(tmp_path):
    path = tmp_path / "map.csv"

    def after_a_block(share, words):
        if " a second" in words:
            raise OSError("enough")

    for overwrite, found in ((False, 30), (False, 60), (True, 90)):
        with pytest.raises(OSError, match="enough"):
            run(path, block=30, progress=after_a_block, overwrite=overwrite)
        assert kept(path) == found
    assert run(path, overwrite=True).computed == 30
    with pytest.raises(OSError, match="enough"):
        run(path, block=30, progress=after_a_block, overwrite=True)
    assert run(path, over={V: [0.1, 0.2]}, overwrite=True).computed == 2


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_every_mixture_of_columns_is_kept_written_and_read(tmp_path, suffix):
    """Numbers, series and texts, alone or together, of scenes of which one fails and one is at rest."""
    kinds = {
        "steady": "load",
        "series": "depth",
        "measure": "peak_to_steady_friction",
        "text": "events",
    }
    chosen = [c for n in (1, 2, 4) for c in itertools.combinations(kinds, n)]
    for number, names in enumerate(chosen):
        asked = {"over": {V: [0.05, 0.0, 1e200]}, "quantities": [kinds[name] for name in names]}
        asked |= {"at": "0 ms:200 ms:3"} if "series" in names else {}
        held = kv.sweep(**asked, rtol=1e-4)
        path = tmp_path / f"{number}{suffix}"
        with pytest.raises(OSError, match="enough"):
            kv.sweep(output=path, block=1, progress=stop, rtol=1e-4, **asked)
        stored = kv.sweep(output=path, rtol=1e-4, **asked)
        assert stored.computed == 2
        assert held.failed == 1
        held.save(tmp_path / f"saved{number}{suffix}")
        saved = kv.sweep(output=tmp_path / f"saved{number}{suffix}", rtol=1e-4, **asked)
        assert saved.computed == 0
        for name, other in itertools.product(held.values, [stored, saved]):
            assert other[name].dtype == held[name].dtype
            assert np.array_equal(other[name], held[name], equal_nan=held.units[name] != ""), name
        if "measure" in names:
            assert np.isnan(held[kinds["measure"]][1:]).all()  # at rest there is no friction
        if "text" in names:
            assert json.loads(held["events"][0])[0]["time"] == 0.0
            assert held["events"][2] == ""


def test_what_cannot_fit_is_refused_with_its_size_before_anything_is_done(tmp_path):
    over = {
        V: "1 mm/s:1 m/s:1000000",
        TAU: "1 ms:1 s:1000000",
        "support.mass": "1 kg/m:2 kg/m:10000",
    }
    for output in (None, tmp_path / "map.csv", tmp_path / "map.nc"):
        with pytest.raises(ValueError, match=r"10,000,000,000,000,000 points need .* years; there"):
            kv.sweep(over=over, output=output)
    assert not list(tmp_path.iterdir())
