"""The documentation site: Sphinx with MyST-NB. `sh scripts/site` builds it."""

project = "Kluft"
author = "The Kluft developers"
html_show_copyright = False
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
# Notebooks are executed by `sh scripts/python notebooks`, which keeps what they show.
nb_execution_mode = "off"
exclude_patterns = ["schema", "site", "**/*.csv"]
html_theme = "furo"
html_title = "Kluft"
html_static_path = []
autodoc_mock_imports = ["kluft._kluft"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
suppress_warnings = ["misc.highlighting_failure"]
