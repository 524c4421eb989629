"""Formulas as MathML, by the converter of the derivations; the site needs no script and no network."""

from html import escape

from kvtheory.derivations.render.html import mathml


def register(app):
    """Register MathML as a renderer with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))


def _inline(self, node):
    from docutils import nodes

    self.body.append(mathml(node.astext().strip()))
    raise nodes.SkipNode


def _block(self, node):
    from docutils import nodes

    latex, _, tag = node.astext().strip().partition(r"\tag{")
    label = tag.removesuffix("}")
    told = label.removeprefix("eq") if label[:2] == "eq" and label[2:].isdigit() else label
    number = f'<span class="number">({escape(told)})</span>' if label else ""
    self.body.append(f'<div class="formula">{mathml(latex)}{number}</div>\n')
    raise nodes.SkipNode
