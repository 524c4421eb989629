"""Proofs kept on disk are read only for the very sources that they were made from."""

import ast
import importlib
import shutil

import pytest
import sympy as sp
from kvtheory.derivations import catalogue
from kvtheory.derivations.engine import book, store
from kvtheory.derivations.engine.step import Proof

CHAPTERS = [catalogue._name(chapter) for chapter in catalogue.CHAPTERS]


@pytest.fixture(autouse=True)
def elsewhere(monkeypatch, tmp_path):
    """Work on a copy of the sources, with neither kept proofs nor results that later tests would see."""
    shutil.copytree(
        store.SOURCES, tmp_path / "sources", ignore=shutil.ignore_patterns("__pycache__")
    )
    monkeypatch.setattr(store, "SOURCES", tmp_path / "sources")
    monkeypatch.setattr(book, "_finished", dict(book._finished))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    return tmp_path / "sources"


@pytest.fixture
def proofs():
    """A proof whose claims hold what SymPy would evaluate when it is read."""
    proof = Proof("kept", None, section="Trial", title="Trial")
    x = sp.Symbol("x", positive=True)
    half = sp.Mul(2 * x + 1, sp.Rational(1, 2), evaluate=False)
    assert half != half.func(*half.args)
    proof.equal(x + sp.Rational(1, 2), half, "one fraction")
    proof.done(x + sp.Rational(1, 2), half)
    return book.finished(["kept"])


def _prove_first(monkeypatch):
    """Return the records of the first chapter, and how often they were proved."""
    chapter, proved = catalogue.CHAPTERS[0], []
    monkeypatch.setattr(catalogue, "_digests", lambda: store.digests(CHAPTERS))
    derive = chapter.result.derive
    with monkeypatch.context() as patch:
        patch.setattr(chapter.result, "derive", lambda: proved.append(1) or derive())
        return catalogue._chapter.__wrapped__(chapter), len(proved)


@pytest.mark.parametrize("name", ["chapters/model", "engine/algebra", "engine/nomenclature"])
def test_one_other_character_and_it_is_proved_anew(monkeypatch, elsewhere, name):
    first, proved = _prove_first(monkeypatch)
    assert proved == 1
    assert _prove_first(monkeypatch) == (first, 0)
    source = elsewhere / f"{name}.py"
    source.write_text(source.read_text(encoding="utf-8") + "#", encoding="utf-8")
    assert _prove_first(monkeypatch) == (first, 1)


def test_a_chapter_rests_on_those_before_it_alone(elsewhere):
    before = store.digests(CHAPTERS)
    changed = CHAPTERS[10]
    (elsewhere / "chapters" / f"{changed}.py").write_text("", encoding="utf-8")
    after = store.digests(CHAPTERS)
    assert [name for name in CHAPTERS if after[name] == before[name]] == CHAPTERS[:10]


def _taken(path):
    """Return the modules of the package that a source imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield from [node.module] if node.module else [each.name for each in node.names]


def test_no_chapter_takes_anything_from_a_later_one(elsewhere):
    taken = {path.stem: set(_taken(path)) for path in elsewhere.glob("chapters/*.py")}
    for place, chapter in enumerate(CHAPTERS):
        reached, last = {chapter}, 0
        while len(reached) > last:
            last = len(reached)
            reached |= set().union(*(taken.get(name, ()) for name in reached))
        assert not reached & set(CHAPTERS[place + 1 :]), chapter


def test_a_version_of_its_own(monkeypatch):
    before = store.digests(CHAPTERS)
    monkeypatch.setattr(store.sp, "__version__", "0")
    assert not set(before.values()) & set(store.digests(CHAPTERS).values())


def test_what_is_kept_is_read_as_it_was(proofs):
    store.keep("trial", "0" * 64, proofs)
    found = store.load("trial", "0" * 64)
    assert found is not proofs
    assert store._content(found) == store._content(proofs)
    assert store.load("trial", "1" * 64) is None


@pytest.mark.parametrize(
    "damage", [lambda text: text[:-1], lambda text: text[:200], lambda text: b""]
)
def test_a_damaged_file_is_not_read(elsewhere, proofs, damage):
    store.keep("trial", "0" * 64, proofs)
    (path,) = elsewhere.glob("__pycache__/trial*")
    path.write_bytes(damage(path.read_bytes()))
    assert store.load("trial", "0" * 64) is None


def test_the_home_takes_what_the_package_cannot(elsewhere, proofs):
    (elsewhere / "__pycache__").write_text("no folder", encoding="utf-8")
    store.keep("trial", "0" * 64, proofs)
    assert store.load("trial", "0" * 64) is not None
    (elsewhere.parent / "home").rename(elsewhere.parent / "gone")
    (elsewhere.parent / "home").write_text("no folder", encoding="utf-8")
    store.keep("other", "0" * 64, proofs)
    assert store.load("other", "0" * 64) is None


def test_proofs_of_the_package_under_another_name_are_not_read(monkeypatch, elsewhere, proofs):
    """`python -m derivations.emit` and `kvtheory derive` import it under two names: two sets of classes."""
    other = importlib.import_module("derivations.engine.store")
    monkeypatch.setattr(other, "SOURCES", elsewhere)
    store.keep("kept", "0" * 64, proofs)
    assert store.load("kept", "0" * 64) is not None
    assert other.load("kept", "0" * 64) is None
