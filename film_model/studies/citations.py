"""What to cite: BibTeX of this package, of its method, and of the models that one impact used.

The sources are those that laws, rules of unloading, effects and friction name; `references.bib` beside this file has an
entry for each, by first author and year. Where a title is not known for sure the entry has none.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from film_model.oblique import friction
from film_model.scene.noses import NOSE, OVAL
from film_model.solve.history import History
from film_model.version import __version__

METHOD = "Big-Alabo, Cartmell & Harrison 2017"
"""Source of the method, FILM."""

SOFTWARE = f"""@software{{film_model,
  author = {{{{film-model contributors}}}},
  title = {{film-model: impacts by the force-indentation linearisation method}}, version = {{{__version__}}}
}}"""

_NAMED = re.compile(r"([^\W\d_a-z][\w-]+)(?:(?:, [^\W\d_][\w-]+)* & [\w-]+| et al\.)? ((?:18|19|20)\d\d)")


def citations(history: History) -> str:
    """BibTeX of the package, of FILM, and of the law, the shape, the effects and the friction that were simulated."""
    law = history.problem.law  # or a rule of unloading around its law
    sources = [METHOD, getattr(law, "law", law).source, law.source]
    sources += [NOSE] if history.scene.nose is not None else [OVAL] if history.scene.oval is not None else []
    sources += [effect.source for effect in history.effects if effect.simulated]
    if history.oblique is not None:
        sources.append(friction.SOURCE)
    entries = references()
    return "\n\n".join([SOFTWARE, *(entries[key] for key in keys(sources) if key in entries)])


def keys(sources: Iterable[str]) -> list[str]:
    """The keys of the works that some sources name, as in "tabor1951", each once.

    >>> from film_model.studies.citations import keys
    >>> keys(["Tabor 1951; Johnson & Cook 1983", "Tabor 1951"])
    ['tabor1951', 'johnson1983']
    """
    found = (match for source in sources for match in _NAMED.findall(source))
    return list(dict.fromkeys(name.lower().replace("-", "").replace("ä", "a") + year for name, year in found))


@cache
def references() -> dict[str, str]:
    """The entries of `references.bib` by their keys."""
    text = (Path(__file__).parent / "references.bib").read_text("utf-8")
    return {entry.partition("{")[2].partition(",")[0]: entry for entry in text.strip().split("\n\n")}
