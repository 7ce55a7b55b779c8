"""The documentation site: Sphinx with MyST-NB. `sh scripts/site` builds it."""

from docutils import nodes
from math_core import LatexError, LatexToMathML
from sphinx.util.logging import getLogger

project = "Kluft"
author = "The Kluft developers"
html_show_copyright = False
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
# Notebooks are executed by `sh scripts/python notebooks`, which keeps what they show.
nb_execution_mode = "off"
exclude_patterns = ["schema", "site", "**/*.csv"]
html_theme = "furo"
html_title = "Kluft"
html_static_path = []
html_math_renderer = "mathml"
autodoc_mock_imports = ["kluft._kluft"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
suppress_warnings = ["misc.highlighting_failure"]


def formula(page, node, tag):
    """A formula as MathML, which browsers show without a script and without a network."""
    is_block = tag == "div"
    try:
        shown = LatexToMathML(fancy_error=False).convert_with_local_state(
            node.astext(), displaystyle=is_block
        )
    except LatexError as error:
        getLogger(__name__).warning("formula: %s", error, location=node)
        raise nodes.SkipNode from None
    style = "overflow: auto hidden; padding: 0.2rem 0" if is_block else ""
    page.body.append(f'{page.starttag(node, tag, "", style=style)}{shown}</{tag}>')
    raise nodes.SkipNode


def setup(app):
    """Formulas are written by `formula`."""
    inline = (lambda page, node: formula(page, node, "span"), None)
    block = (lambda page, node: formula(page, node, "div"), None)
    app.add_html_math_renderer("mathml", inline, block)
