"""The text around the derivations: title, introduction, vocabulary, nomenclature, source."""

import re

TITLE = "Sliding friction on viscoelastic foundations: derivations"

AUTHORS = "Nakano and Kono (2020)"

INTRODUCTION = (
    "A rigid cylinder presses into a row of independent Kelvin–Voigt elements and slides over it. "
    f"{AUTHORS} state the model, its transient and its steady state in numbered equations; here "
    "each of them is defined or derived, together with further results on this model, on other shapes and "
    "foundations, and on a drive with a spring: the theorems F1 and so on. Equation numbers without a letter "
    "are those of the paper.",
    "Every line is an equality or an inequality that computer algebra checked when this document "
    "was made; if a check fails, no document is made. Each line is followed by its reason and a "
    "sign for the status of its check; the sentence before it lists the premises: definitions, and results "
    "established elsewhere, by their number, with their formula where that is short. A result has the status "
    "of its weakest line.",
    "A check establishes the formula of its line, on the domain that is given with it, from the "
    "definitions and results that are named; what is printed was read back and compared with what was "
    "checked. The words after a line say what the formula means for the contact; they are not "
    "checked, nor that a law of the model is right. Where the lines alone do not prove the title, the text "
    "says what is argued, and the result is called argued.",
)

VOCABULARY = {
    "definition": "a name or a law of the model is introduced; there is nothing to prove",
    "proved": "an identity, a sign or a number of roots, proved by exact algebra",
    "proved-leading-order": "an asymptote, proved with the coefficient and the order of its "
    "remainder",
    "argued": "its lines are proved, but the title also rests on words of the text, which are marked",
}
"""The meaning of each `record.STATUSES`."""

SIGNS = {
    "definition": "≝",
    "proved": "∎",
    "proved-leading-order": "≈",
    "argued": "†",
}
"""The sign after a line with this status."""

SOURCE = (
    "K. Nakano and M. Kono, Transient and steady sliding friction of elastomers: impact of "
    "vertical lift, Frontiers in Mechanical Engineering 6, 38 (2020)."
)
DOI = "10.3389/fmech.2020.00038"

MARKS = (
    "A dot over a symbol is its derivative with respect to time $t$, a prime the one with respect to "
    "its argument; of scaled quantities of the transient, with respect to the scaled time. A letter "
    "stands for a positive number unless its row says otherwise. What few sections use is in a table at "
    "their beginning; there a letter may mean something else than elsewhere."
)
"""The text above the nomenclature."""

WITH_NUMBERS = "With these numbers:"


def code_span(text: str) -> str:
    """Return text as code in Markdown, whatever it holds: in more backticks than follow each other in it.

    >>> code_span("derive"), code_span("a`<b>`")
    ('`derive`', '`` a`<b>` ``')
    """
    fence = "`" * (max(map(len, re.findall("`+", text)), default=0) + 1)
    return f"{fence}{text}{fence}" if len(fence) == 1 else f"{fence} {text} {fence}"


def numbers_of(scene: str) -> str:
    """Return the sentence about the numbers beside the formulas."""
    return (
        f"Closed forms are followed by their values for {scene}; the nomenclature lists the input."
    )
