"""Printing: the files are complete, correct in their format, and fit their page."""

import json
import re
import subprocess
import xml.etree.ElementTree as ET
from contextlib import closing
from pathlib import Path

import generators
import pytest
from generators import derivations as site_derivations
from generators.labels import anchor_of
from kvtheory.derivations.catalogue import SYMBOLS, catalogue
from kvtheory.derivations.engine.atoms import atoms
from kvtheory.derivations.engine.letters import letters
from kvtheory.derivations.engine.record import STATUSES, Derivation, Step, Table
from kvtheory.derivations.render import (
    RenderError,
    edition,
    fragments,
    frame,
    html,
    latex,
    latex_engine,
    markdown,
    pdf,
    write,
)
from kvtheory.derivations.render.edition import Edition, symbols_of
from kvtheory.derivations.render.inline import inline
from kvtheory.derivations.render.text import Given, Line, blocks, by_section, sentence

from tests.browser import Browser
from tests.conftest import required

SAMPLE = (
    Derivation(
        "eq3", 3, "Geometry", "Indenter at $x = 0$",
        'Half of "it", 50 % & more: a_b #1 {c} ~ ^ \\ <d> |e|, see Eq. (27) and Eq. (99).',
        r"h{\left(x \right)} = \frac{x^{2}}{2 R}", "definition",
        (Step(r"h{\left(x \right)}", "=", r"\frac{x^{2}}{2 R}", "5 % & #1_2", "definition"),),
    ),
    Derivation(
        "eq27", 27, "Contact", "Trailing edge", "", r"x = \sqrt{a^{2}}", "argued",
        (Step("x", "=", r"\int\limits_{0}^{a} 1\, dt = a", "Eq. (3)", "proved"),), uses=("eq3", "F9"),
        table=Table(("A & B", "$x$"), (("1 %", r"$\frac{1}{2}$"),)),
    ),
)  # fmt: skip


@pytest.fixture(scope="session")
def everything() -> tuple[Derivation, ...]:
    return catalogue()


@pytest.fixture(scope="session")
def book(everything) -> Edition:
    return edition(everything, command="kvtheory derive")


@pytest.fixture(scope="session")
def page(book) -> str:
    return html.document(book)


@pytest.fixture(scope="session")
def as_tex(everything, tmp_path_factory) -> Path:
    """A folder with everything as LaTeX."""
    folder = tmp_path_factory.mktemp("everything")
    write(everything, folder, ["tex"])
    return folder


def overfull(log: str) -> list[float]:
    return [float(width) for width in re.findall(r"Overfull \\hbox \((\S+?)pt", log)]


# The catalogue and the nomenclature


def test_labels_fit_file_names_and_every_status_has_a_meaning(everything):
    assert all(re.fullmatch(r"[A-Za-z0-9-]+", each.label) for each in everything)
    assert tuple(frame.VOCABULARY) == STATUSES


def test_each_symbol_is_in_the_nomenclature_once_with_a_meaning_and_a_unit(book, everything):
    listed = [symbol.latex for symbol in SYMBOLS]
    shown = {symbol: each.label for each in everything for symbol in symbols_of(each)}
    assert set(shown) == set(listed), shown
    assert len(set(listed)) == len(listed)
    assert [next(atoms(letter)).symbol for letter in listed] == listed
    assert all(symbol.meaning and symbol.unit for symbol in SYMBOLS)
    words = {"", "coordinate", "counter", "constant", "sign", "dimension"}
    found = [*book.nomenclature, *(row for rows in book.chapters.values() for row in rows)]
    assert {symbol.source for symbol in found} <= {each.label for each in everything} | words


def test_a_section_has_letters_of_its_own_without_accents_that_it_does_not_need(book, everything):
    accented, shown = 0, 0
    for section, members in by_section(book.derivations).items():
        letters = {letter for each in members for letter in symbols_of(each)}
        rows = [row.latex for row in book.chapters[section]]
        assert letters <= {*rows, *(row.latex for row in book.nomenclature)}, section
        assert len(set(rows)) == len(rows)
        bare = {
            letter: re.sub(r"\\(?:bar|hat|tilde|breve|check) ?", "", letter) for letter in letters
        }
        changed = {each for each in bare if bare[each] != each}
        assert {bare[each] for each in changed} <= letters | {"e", "i", "d", r"\pi"}, section
        accented, shown = accented + len(changed), shown + len(letters)
    assert accented < shown / 8
    assert len(book.nomenclature) < 130
    alone = edition(everything, ["F17"]).derivations[0]
    assert alone in book.derivations


def test_no_letter_is_renamed_to_one_that_its_chapter_uses_otherwise(everything):
    for each in everything:
        new = letters(each.label, each.section)
        assert len(set(new.values())) == len(new), each.label


# What is given stands in sentences, the rest in lines


def told(block) -> str:
    return "".join(
        f"${piece.content}$" if piece.kind == "math" else piece.content
        for piece in sentence(block, {"eq3"})
    )


@pytest.mark.parametrize(
    ("displayed", "told"),
    [
        (r"\frac{a + b}{c d} - \frac{1}{2}", "(a + b)/(c d) - 1/2"),
        (r"\frac{K}{3 R} \left(1 + \frac{l}{a}\right)", "K (1 + l/a)/(3 R)"),
        (r"\frac{a}{b} \frac{1}{c}", "a/(b c)"),
        (r"\frac{a}{R} \frac{b}{4 - c}", "a b/(R (4 - c))"),
        (r"\frac{G_2(c)}{G_1(c)} + \frac{1}{\sqrt[3]{z}}", r"G_2(c)/G_1(c) + 1/\sqrt[3]{z}"),
        (r"\frac{a/b}{c/d}", "(a/b)/(c/d)"),
        (r"\frac{W}{l_{\mathrm{r}}}", r"W/l_{\mathrm{r}}"),
        (r"\alpha \sqrt{\frac{\delta}{R}}", r"\alpha \sqrt{\delta/R}"),
        (r"\left(\frac{a}{b}\right)^{\frac{2}{3}}", "(a/b)^{2/3}"),
        (r"\frac{\mathrm{d} a}{\mathrm{d} t}", r"\mathrm{d} a/\mathrm{d} t"),
        (r"\frac{\mathrm{d}}{\mathrm{d} q} \frac{a}{b}",)
        * 2,  # what takes in what follows keeps its line
        (r"\frac{1}{R} \int f",) * 2,
        (r"\ln \frac{a}{b}",) * 2,
    ],
)
def test_fractions_in_a_line_of_text_have_a_slash(displayed, told):
    assert inline(displayed) == told


def test_what_is_given_is_told_in_sentences():
    steps = (
        Step("h", "=", r"\frac{x^{2}}{2 R}", "", "definition", "eq3"),
        Step("W", "=", r"\int_{a = 0}^{b} p\, dx = \frac{K}{2}", "", "proved", "load"),
        Step("F", "=", "2 K", "", "proved", "load"),
        Step("x", "=", "a", "the edge", "definition"),
        Step("p", "=", "1", "proved here", "proved"),
        Step("q", "=", "1", "", "definition"),
        Step("m", "=", "F", "the result", "definition"),
        Step("n", "=", "1", "", "definition"),
    )
    found = list(blocks(Derivation("m", None, "S", "T", "", "m = F", "proved", steps)))
    assert told(found[0]) == (
        r"With $h = x^{2}/(2 R)$ (3), $W = K/2$, $F = 2 K$ (load) and "
        "$x = a$ (the edge),"
    )
    assert [told(found[2]), told(found[4])] == ["With $q = 1$,", "With $n = 1$."]
    assert [found[1], found[3]] == [Line(steps[4]), Line(steps[6], "m")]
    links = [piece.target for piece in sentence(found[0], {"eq3"}) if piece.kind == "link"]
    assert links == ["eq3"]


@pytest.mark.parametrize(
    ("right", "in_a_sentence"),
    [
        (r"\frac{\left(1 - q\right)^{2}}{x_{\mathrm{TE}}} + \sqrt{\frac{1}{2}}", True),
        (" + ".join("abcdefghijklmnopqrst"), True),
        (" + ".join("abcdefghijklmnopqrstuvwxyzABCDEFG"), False),
        (r"\int_{a}^{b} p\, dx", False),
        (r"\begin{cases} 1 & q \\ 2 & l \end{cases}", False),
        (r"\frac{1 + \frac{l}{4}}{w}", True),  # with slashes
        (r"\begin{pmatrix} \frac{1}{2} \end{pmatrix}", False),
    ],
)
def test_only_what_fits_a_line_of_text_is_told_in_a_sentence(right, in_a_sentence):
    steps = (Step("y", "=", right, "", "definition"), Step("z", "=", "1", "", "proved"))
    first, _ = blocks(Derivation("z", None, "S", "T", "", "z = 1", "proved", steps))
    assert isinstance(first, Given) == in_a_sentence
    recalled = Step(
        "F", "=", r"K u, \quad u = \delta", "", "proved", "load"
    )  # two relations, not cut
    given, _ = blocks(Derivation("z", None, "S", "T", "", "z = 1", "proved", (recalled,)))
    assert told(given) == r"With $F = K u, \quad u = \delta$ (load),"


# The site


def test_the_pages_of_the_site_have_each_derivation_once(everything, site):
    pages = site_derivations.pages()
    assert {
        f"theory/{name}.md" for name in re.findall(r"^[a-z0-9-]+$", pages["theory/index.md"], re.M)
    } == (set(pages) - {"theory/index.md"})
    anchors = re.findall(r"^\((\S+)\)=$", "\n".join(pages.values()), re.MULTILINE)
    assert sorted(anchors) == sorted(anchor_of(each.label) for each in everything)
    site_derivations.write(site)
    generators.made("derivations", site)


# JSON


def test_a_root_is_printed_with_its_equation_and_a_result_with_its_conditions(book, everything):
    records = {each.label: each for each in everything}
    roots = [
        step for each in everything for step in each.steps
        if step.claim and step.claim.check == "root" and not step.source
    ]  # fmt: skip
    assert len(roots) > 35
    assert all(re.match("the only (real )?root of [$]", step.note) for step in roots)
    (crossing,) = [
        step.latex for step in records["F12-table1"].steps if step.claim.check == "unique_root"
    ]
    assert crossing.endswith(r"= 0 \quad\text{for exactly one } q \in (0, 1)")
    assert book.domain(records["energy-split"]) == "Assumed, not proved: $F > 0$."
    for each in book.derivations:
        said = {part for step in each.steps for part in (step.latex, step.domain)}
        told = book.domain(each)
        left = [part for part in each.domain if part not in said and part not in told]
        left = [
            part for part in left if not re.fullmatch(r"[^ ]+ > 0", part)
        ]  # of a positive letter
        assert all(any(other.endswith(f" < {part}") for other in each.domain) for part in left)
        assert not re.search(r"(\d) < (\S+) < (\d)\$, \$\2 < \3", told)


ASSUMED = {
    "energy-split": "that friction resists sliding is what the next record shows of any shape",
    "energy-any-shape": "the result, a sum of squares, shows it",
    "F18-voigt": "F18-lacks says that these differences are zero for a dashpot alone",
}
"""The records that assume a sign which they do not prove, and why they may."""


def test_few_records_assume_a_sign_that_they_do_not_prove(book, everything):
    assert {each.label for each in everything if "ssumed" in book.domain(each)} == {*ASSUMED}


def test_json_keeps_the_contract(book, everything, tmp_path):
    write(everything, tmp_path, ["json"])
    entries = json.loads((tmp_path / "derivations.json").read_text(encoding="utf-8"))
    assert [entry["label"] for entry in entries] == [each.label for each in everything]
    for entry, each in zip(entries, book.derivations, strict=True):
        assert entry["status"] in STATUSES
        assert (entry["equation"], entry["latex"]) == (each.equation, each.latex)
        assert entry["latex"]
        assert set(entry) >= {"title", "section", "text", "uses"}
        assert [step["latex"] for step in entry["steps"]] == [step.latex for step in each.steps]
        assert all(
            set(step) == {"latex", "reason", "status", "source", "domain"}
            for step in entry["steps"]
        )
        assert entry["domain"] == list(each.domain)
        assert entry["premises"] == list(each.premises)


# HTML


def test_html_is_well_formed_and_complete_and_needs_nothing_from_elsewhere(page, everything):
    # A self-closing void element is the only thing in which HTML is not XML here.
    tree = ET.fromstring(re.sub(r"<meta ([^>]*)>", r"<meta \1/>", page.partition("\n")[2]))
    assert tree.attrib["lang"] == "en"
    assert tree.findtext("head/title")
    assert [each.get("id") for each in tree.iter("article")] == [each.label for each in everything]
    results = [each.findtext("./span[@class='number']") for each in tree.iter("li")]
    assert len([text for text in results if text]) == len(everything)
    assert not {each.tag for each in tree.iter()} & {
        "script", "link", "img", "iframe", "object", "embed"
    }  # fmt: skip
    assert not re.search(r"url\(|@import", page)
    calls = ("href", "src", "srcset", "data", "action")
    targets = [(e.tag, e.get(key)) for e in tree.iter() for key in calls if e.get(key)]
    assert {tag for tag, _ in targets} == {"a"}
    names = [each.get("id") for each in tree.iter() if each.get("id")]
    assert len(set(names)) == len(names)
    inside = {target[1:] for _, target in targets if target.startswith("#")}
    assert {each.label for each in everything} <= inside <= set(names)
    outside = {target for _, target in targets if not target.startswith("#")}
    assert outside == {f"https://doi.org/{frame.DOI}"}
    given = tree.find(".//section[@id='nomenclature']")
    assert {"#scaling", "#load"} <= {each.get("href") for each in given.iter("a")}
    reasons = [each for each in tree.iter("p") if each.get("class") == "reason"]
    assert all((each.text or "").strip() or len(each) > 1 for each in reasons)  # no sign alone
    assert "Kelvin-Voigt" not in page


def test_mathml_knows_every_macro_and_is_upright_where_the_symbol_is():
    with pytest.raises(RenderError, match=r"\\nosuch"):
        html.mathml(r"\frac{1}{\nosuch}")
    assert html.mathml(r"l_{\mathrm{r}}").count('mathvariant="normal"') == 1
    assert html.mathml(r"l_{r}").count('mathvariant="normal"') == 0
    assert "<mo>&#x0223C;</mo>" in html.mathml(r"a \sim b")
    assert "<mo>&#x02217;</mo>" in html.mathml("V^{*}")
    assert html.mathml("w_{0}''").count("<msubsup>") == 1


def test_html_escapes_text_and_links_references():
    shown = html.document(edition(SAMPLE, command="a <b> & c"))
    assert "50 % &amp; more: a_b #1 {c} ~ ^ \\ &lt;d&gt; |e|" in shown
    assert 'see Eq. <a href="#eq27">(27)</a> and Eq. (99).' in shown
    assert "<code>a &lt;b&gt; &amp; c</code>" in shown
    assert 'Rests also on <a href="#eq3">(3)</a>, (F9)' in shown


def test_html_fits_a_phone(page, tmp_path):
    (tmp_path / "page.html").write_text(page, encoding="utf-8")
    with closing(Browser(tmp_path / "profile")) as browser:
        browser.screen(360, 800, phone=True)
        browser.open(tmp_path / "page.html")
        sizes = "[scroll.clientWidth, scroll.scrollWidth, document.querySelectorAll('math').length]"
        client, scroll, formulas = browser.run(f"(scroll => {sizes})(document.documentElement)")
        browser.screen(390, 844, phone=True)
        wide = browser.run(
            "[...document.querySelectorAll('.line .scroll')].filter("
            "each => each.scrollWidth > each.clientWidth + 1).length"
        )
    assert formulas > 100
    assert scroll <= client <= 360
    assert wide <= 20  # fractions and values at a place, which cannot be broken


# LaTeX and PDF


def test_article_compiles_without_loose_ends(book):
    required("pdflatex")
    made, log = pdf.typeset(latex.article(book))
    assert made.startswith(b"%PDF")
    assert not re.search(
        r"undefined|Rerun to get|Token not allowed|multiply.defined|LaTeX Warning", log
    )
    assert max(overfull(log), default=0.0) <= 10


def test_article_escapes_text_and_is_reproducible():
    required("pdflatex")
    source = latex.article(edition(SAMPLE, command="derive --only a_b & 5%"))
    assert "Half of ``it''," in source
    assert r"50 \% \& more: a\_b \#1 \{c\} \textasciitilde{}" in source
    assert r"\hyperref[eq27]{(27)} and Eq. (99)" in source
    assert pdf.typeset(source)[0] == pdf.typeset(source)[0]


def compiled(
    directory: Path, names: list[str], references: str = "", start: str = r"\documentclass{article}"
) -> str:
    """Return the log of a bare document of these fragments."""
    inputs = "\n".join(rf"\input{{fragments/{name}}}" for name in names)
    (directory / "own.tex").write_text(
        rf"{start}\usepackage{{amsmath}}\renewcommand\thepage{{}}\begin{{document}}"
        f"{references}\n{inputs}\n\\end{{document}}\n"
    )
    options = ("-draftmode", "-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error")
    call = [required("pdflatex"), *options, "own.tex"]
    for _ in range(2):  # no third, which references to pages would need
        done = subprocess.run(call, cwd=directory, capture_output=True, check=False)
        assert done.returncode == 0, done.stdout[-800:]
    return (directory / "own.log").read_text(errors="replace")


@pytest.mark.parametrize("kind", ["", "-steps"])
def test_fragments_compile_in_a_bare_document_without_an_overfull_box(everything, as_tex, kind):
    names = [f"{each.label}{kind}.tex" for each in everything]
    references = " ".join(rf"\eqref{{kv:{each.label}}}" for each in everything)
    written = {path.name for path in (as_tex / "fragments").iterdir()}
    assert written == {f"{each.label}{end}.tex" for each in everything for end in ("", "-steps")}
    log = compiled(as_tex, names, references)
    assert not re.search(r"LaTeX Warning", log)
    assert overfull(log) == []


def test_a_fragment_stands_alone(everything, tmp_path):
    write(everything, tmp_path, ["tex"], only=["eq46"])
    assert not re.search(r"LaTeX Warning|undefined", compiled(tmp_path, ["eq46-steps.tex"]))


def test_fragments_keep_to_labels_of_their_own(everything, tmp_path):
    """A document may have a section of the same name; `--label-prefix` keeps two editions apart."""
    write(everything, tmp_path, ["tex"], only=["load", "F3"])
    own = r"\section{Load}\label{load} Section~\ref{load}, Eqs.~\eqref{kv:load} and \eqref{kv:F3}"
    assert "LaTeX Warning" not in compiled(tmp_path, ["load.tex", "F3-steps.tex"], own)
    other = edition(everything, ["eq27"], label_prefix="nk-")
    text = fragments.with_steps(other.derivations[0], other)
    assert r"\label{nk-eq27}" in text
    assert r"\derivationref{nk-eq28}" in text


@pytest.mark.parametrize("kind", ["article", "amsart"])
def test_two_editions_share_an_article_of_somebody_else(everything, tmp_path, kind):
    """It has sections, equations and a theorem of the same names, and links."""
    labels, names = ["eq27", "F3", "F11", "F24-damper"], []
    (tmp_path / "fragments").mkdir()
    for prefix in "ab":
        printing = edition(everything, labels, label_prefix=f"{prefix}:")
        for each in printing.derivations:
            if each.label in labels:
                names.append(f"{prefix}-{each.label}.tex")
                text = fragments.with_steps(each, printing)
                (tmp_path / "fragments" / names[-1]).write_text(text)
    references = " ".join(rf"\eqref{{{one}:{each}}}" for one in "ab" for each in labels)
    own = (
        r"\title{Sliding}\author{A. Nother}\maketitle\section{Load}\label{load}"
        r"\begin{equation}\label{eq27}W = 1\end{equation}\begin{lemma}\label{F3}By \eqref{eq27},"
        rf" Section~\ref{{load}}, Lemma~\ref{{F3}} and {references}.\end{{lemma}}"
    )
    packages = r"\usepackage{amssymb,amsthm}\usepackage{hyperref}\newtheorem{lemma}{Lemma}"
    log = compiled(tmp_path, names, own, rf"\documentclass{{{kind}}}{packages}")
    assert not re.search(r"Warning|undefined|multiply", log)
    assert max(overfull(log), default=0.0) <= 1


def test_fragments_are_broken_for_a_page_of_two_columns(everything, tmp_path):
    (tmp_path / "fragments").mkdir()
    wide = {}
    for columns in (1, 2):
        printing = edition(everything, ["eq27", "F3", "F11", "F17-parts"], columns=columns)
        for each in printing.derivations:
            text = fragments.with_steps(each, printing)
            (tmp_path / "fragments" / f"{each.label}.tex").write_text(text)
        names = [f"{each.label}.tex" for each in printing.derivations]
        log = compiled(tmp_path, names, start=r"\documentclass[twocolumn]{article}")
        wide[columns] = max(overfull(log), default=0.0)
    assert wide[1] > 10
    assert wide[2] <= 1


def test_a_sign_without_a_reason_stands_beside_its_formula(book):
    text = markdown.document(book)
    for sign in frame.SIGNS.values():
        assert f"\n{sign}\n" not in text
    assert "l_{\\mathrm{r}} = a l \\quad \\text{∎}\n$$" in text


def test_the_document_counts_the_equations_of_a_fragment(book, everything):
    texts = {each.label: fragments.with_steps(each, book) for each in everything}
    for each in everything:
        for text in (fragments.equation(each, book), texts[each.label]):
            assert r"\tag" not in text
            assert text.count(rf"\label{{kv:{each.label}}}") == 1
    assert r"\derivationref{kv:eq28}{(28 of Nakano and Kono)}" in texts["eq27"]
    assert not re.search(r"(?<![\w}])\(\d+\)", texts["eq27"])
    assert r"\item[$l_{\mathrm{r}}$] retardation length, $V \tau$ [m]," in texts["eq27"]
    assert "Symbols, positive unless another sign is given:" in texts["eq27"]
    assert "It holds for $q < 1$." in texts["eq42"]


def test_wrong_mathematics_is_an_error_with_the_message_of_the_engine():
    required("pdflatex")
    with pytest.raises(RenderError, match="Undefined control sequence"):
        pdf.typeset(r"\documentclass{article}\begin{document}$\nosuch$\end{document}")


def test_no_engine_is_a_clear_error(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert latex_engine() is None
    with pytest.raises(RenderError, match="install texlive-latex-base or leave pdf out"):
        write(SAMPLE, tmp_path / "out", ["json", "pdf"])
    assert not (tmp_path / "out").exists()


# Choosing and writing


def test_only_the_chosen_are_written(tmp_path):
    write(SAMPLE, tmp_path, ["tex", "json"], only=["eq27"])
    entries = json.loads((tmp_path / "derivations.json").read_text())
    assert [entry["label"] for entry in entries] == ["eq27"]
    names = {path.name for path in (tmp_path / "fragments").iterdir()}
    assert names == {"eq27.tex", "eq27-steps.tex"}
    assert r"\hyperref[eq3]" not in (tmp_path / "derivations.tex").read_text()
    for formats, only, near in (["json"], ["eq28"], "eq27"), (["htm"], [], "html"):
        with pytest.raises(ValueError, match=f"the nearest is '{near}'"):
            write(SAMPLE, tmp_path / "out", formats, only)
    assert not (tmp_path / "out").exists()


def test_a_family_or_a_closure_is_chosen_in_order(everything):
    families = edition(everything, ["F4", "F1"]).derivations
    assert [each.label for each in families] == ["F1", "F4-low", "F4-high"]
    chosen = edition(everything, ["eq46"], with_premises=True).derivations
    labels = [each.label for each in chosen]
    assert labels[-1] == "eq46"
    assert {"eq3", "eq28", "eq29", "F21", "F21-steady"} <= set(labels)
    for place, each in enumerate(chosen):
        assert set(each.uses) <= set(labels[:place])


def test_a_failing_write_leaves_the_old_files(tmp_path, monkeypatch):
    target = tmp_path / "derivations.json"
    target.write_text("old")

    def full(self, content):
        self.touch()
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="no space left"):
        write(SAMPLE, tmp_path, ["json"])
    assert [path.name for path in tmp_path.iterdir()] == ["derivations.json"]
    assert target.read_text() == "old"


def test_an_unpaired_dollar_is_an_error():
    lone = Derivation("eq1", 1, "S", "T", "costs $5", "x = 1", "definition")
    with pytest.raises(ValueError, match="without its partner"):
        write([lone], Path("unused"), ["html"])
