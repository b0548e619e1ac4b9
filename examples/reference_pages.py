"""docs/laws.md and docs/laws.png: every contact law with its equations, parameters and sources, from the code."""

import inspect
import sys
from pathlib import Path

from film_model.laws import LAWS, AbstractLaw, Parameter
from film_model.laws.law import law_fields
from film_model.laws.unloading import UNLOADINGS
from film_model.plot import plot_laws

DOCS = Path(__file__).parents[1] / "docs"
FROM_SCENE = ("effective_modulus", "radius", "yield_strength", "poissons_ratio")


def laws_page() -> str:
    """The laws and the rules of unloading as Markdown."""
    rows = "\n".join(f"| [`{name}`](#{name}) | {law.summary} | {law.source} |" for name, law in LAWS.items())
    laws = "\n".join(_section(name, law) for name, law in LAWS.items())
    rules = "\n".join(_section(name, law) for name, law in UNLOADINGS.items())
    return f"""# Contact laws

Made from the code by `python examples/reference_pages.py`. The name goes into a scene's `[contact]` as `law = "…"`,
with the parameters below; a quantity has a unit. δ: indentation, F: contact force, K = (4/3) E √R: Hertz's stiffness.

![One impact under every law](laws.png)

| law | | source |
|---|---|---|
{rows}

{laws}
# Rules of unloading

`unloading = "…"` in `[contact]` gives a law that is not damped another way to open.

{rules}"""


def _section(name: str, law: type[AbstractLaw]) -> str:
    own = "\n".join(f"- `{key}`: {_parameter(value)}" for key, value in law.parameters.items())
    from_scene = ", ".join(f"`{key}`" for key in law_fields(law) if key in FROM_SCENE)
    lines = [f"## {name}", inspect.cleandoc(law.__doc__ or ""), f"Valid: {law.validity}."]
    lines += [f"Parameters:\n\n{own}"] if own else []
    lines += [f"From the scene: {from_scene}."] if from_scene and name in LAWS else []
    return "\n\n".join(lines) + "\n"


def _parameter(parameter: Parameter) -> str:
    kind = " or ".join(f"`{choice}`" for choice in parameter.choices) or parameter.dimension.replace("_", " ")
    kind = f"a list, each a {kind}" if parameter.several else kind
    return f"{parameter.help} ({kind}{'' if parameter.required else ', optional'})"


def main(folder: Path = DOCS) -> list[Path]:
    """Write the pages; returns their paths."""
    page, picture = folder / "laws.md", folder / "laws.png"
    page.write_text(laws_page(), encoding="utf-8")
    plot_laws(picture, dpi=80.0)
    return [page, picture]


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:])):
        print(path)
