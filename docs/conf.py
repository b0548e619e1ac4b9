"""Settings of the documentation site: python -m sphinx -W --keep-going -q docs build/site."""

import inspect
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

from film_model import Scene, __version__
from film_model.explorer.page import write_page

project = "film-model"
author = copyright = "film-model contributors"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]

exclude_patterns = ["paper"]  # for a journal, in its own Markdown

myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 3
html_math_renderer = "mathml"

autodoc_member_order = "bysource"
autodoc_typehints = "none"
default_role = "code"  # docstrings quote names in single backticks

html_theme = "pydata_sphinx_theme"
html_title = f"film-model {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_context = {"default_mode": "auto"}
html_theme_options = {
    "show_prev_next": False,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}
html_sidebars = {"explorer": []}
html_show_sourcelink = False
html_copy_source = False

SCENE = Path(__file__).parents[1] / "examples" / "scenes" / "steel_ball_on_steel.toml"


def inline_formula(writer: HTML5Translator, node: nodes.math) -> None:
    """A formula in a line as MathML, which browsers draw without a script."""
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def displayed_formula(writer: HTML5Translator, node: nodes.math_block) -> None:
    """A formula on lines of its own."""
    writer.body.append(f'<div class="formula">{tex2mathml(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def emphasise_names(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Docstrings explain arguments and fields as "name: meaning.": make those names bold."""
    if what in ("class", "function", "method"):
        names = "|".join(inspect.signature(thing).parameters)
        lines[:] = [re.sub(rf"(?:(?<=^)|(?<= ))({names}): ", r"**\1**: ", line) if names else line for line in lines]


def write_explorer(app: Sphinx, error: Exception | None) -> None:
    """Write the page with sliders beside the page that embeds it."""
    if error is None:
        write_page(Path(app.outdir, "explorer_page.html"), Scene.from_toml(SCENE))


def setup(app: Sphinx) -> None:
    """Add the formulas, the names in docstrings, and the explorer."""
    app.add_html_math_renderer("mathml", (inline_formula, None), (displayed_formula, None))
    app.connect("autodoc-process-docstring", emphasise_names)
    app.connect("build-finished", write_explorer)
