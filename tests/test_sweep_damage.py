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
def test_a_file_of_which_any_byte_was_lost_or_changed_is_never_taken_for_whole(
    tmp_path, suffix, whole
):
    path, content, chance = tmp_path / f"map{suffix}", whole[suffix], random.Random(1)
    ends = [*np.linspace(1, len(content) - 1, 25).astype(int), len(content) - 1]
    damaged = [b"", content + b"\n", *(content[:end] for end in ends)]
    for _ in range(50):
        at = chance.randrange(len(content))
        damaged.append(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    for spoilt in damaged:
        path.write_bytes(spoilt)
        with pytest.raises(ValueError, match=r"not a sweep as it was written.*overwrite"):
            run(path)
        assert path.read_bytes() == spoilt
    run(path, overwrite=True)
    assert run(path).computed == 0
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


LINES = {
    "an axis": lambda lines: lines[-1].__setitem__(0, "11"),
    "a value": lambda lines: lines[-1].__setitem__(3, "7"),
    "a unit": lambda lines: lines[HEADS].__setitem__(1, f"{TAU} [ms]"),
    "a name": lambda lines: lines[HEADS].__setitem__(3, "halflength [m]"),
    "the order of columns": lambda lines: [line.insert(2, line.pop(3)) for line in lines[HEADS:]],
    "the order of rows": lambda lines: lines.insert(HEADS + 1, lines.pop(HEADS + 2)),
    "a repeated row": lambda lines: lines.insert(HEADS + 1, lines[HEADS + 2]),
    "the scene": lambda lines: text(lines, "10000000000.0", "20000000000.0"),
    "the certificate": lambda lines: text(lines, "certificate", "proof"),
    "an error": lambda lines: text(lines, "relative_error", "relative_errors"),
    "the version": lambda lines: text(lines, "# version: 0", "# version: 1"),
    "the digest": lambda lines: text(lines, "sha256", "sha512"),
    "a remark": lambda lines: lines.insert(1, ["# measured on Monday"]),
}
"""What is altered in the cells of a CSV."""
HEADS = -121


def text(lines, old, new):
    found = [line for line in lines if any(old in cell for cell in line)]
    assert found
    for line in found:
        line[:] = [cell.replace(old, new) for cell in line]


NODES = {
    "an axis": lambda data: data[V].__setitem__(0, 7.0),
    "a value": lambda data: data["depth"].__setitem__((17, 1), data["depth"][17, 1] * (1 + 1e-15)),
    "a unit": lambda data: data[TAU].setncattr("units", "ms"),
    "a unit of a quantity": lambda data: data["load"].setncattr("units", "N"),
    "a name": lambda data: data.renameVariable("half_length", "halflength"),
    "the name of a dimension": lambda data: data.renameDimension(TAU, "tau"),
    "the order of rows": lambda data: data["load"].__setitem__(..., data["load"][::-1]),
    "the scene": lambda data: data.setncattr("scene", data.scene.replace("0.1", "0.2")),
    "the certificate": lambda data: data.setncattr("certificate", "exact"),
    "an error": lambda data: data.setncattr("summary", data.summary.replace("e-1", "e-2")),
    "the version": lambda data: data.setncattr("kvtheory_version", "9"),
    "a remark": lambda data: data.setncattr("history", "measured on Monday"),
    "a failure": lambda data: data.createDimension("more", 1),
}
"""What is altered in NetCDF by its own library."""


@pytest.mark.parametrize("what", LINES)
def test_whatever_is_altered_in_a_csv_is_noticed(tmp_path, what, whole):
    path = tmp_path / "map.csv"
    lines = [line.split(",") for line in whole[".csv"].decode().split("\r\n")[:-1]]
    assert lines[HEADS][0] == f"{V} [m/s]"
    LINES[what](lines)
    path.write_bytes("".join(",".join(line) + "\r\n" for line in lines).encode())
    assert path.read_bytes() != whole[".csv"]
    with pytest.raises(ValueError, match="not a sweep as it was written"):
        run(path)


@pytest.mark.parametrize("what", NODES)
def test_whatever_is_altered_in_netcdf_is_noticed(tmp_path, what, whole):
    import netCDF4

    path = tmp_path / "map.nc"
    path.write_bytes(whole[".nc"])
    with netCDF4.Dataset(path, "a") as data:
        NODES[what](data)
    with pytest.raises(ValueError, match="not a sweep as it was written"):
        run(path)


def test_what_reads_a_file_does_not_mind_its_digest_and_what_saves_it_anew_is_told(tmp_path, whole):
    import xarray

    path = tmp_path / "map.nc"
    path.write_bytes(whole[".nc"])
    with xarray.open_dataset(path) as data:
        assert data["load"].shape == (40, 3)
        copy = data.load()
    assert run(path).computed == 0
    copy.to_netcdf(path)
    with pytest.raises(ValueError, match="saved anew by another program"):
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
