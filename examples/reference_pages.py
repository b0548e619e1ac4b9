"""docs/laws.md, docs/laws.png and docs/effects.md: contact laws and effects with their equations, from the code."""

import inspect
import sys
from pathlib import Path

import film_model as fm
from film_model.effects import COMPUTED, effects_of
from film_model.explain import effects_text
from film_model.laws import LAWS, AbstractLaw, Parameter
from film_model.laws.law import law_fields
from film_model.laws.unloading import UNLOADINGS
from film_model.limits import RULES
from film_model.plot import plot_laws

DOCS, SCENES = Path(__file__).parents[1] / "docs", Path(__file__).parent / "scenes"
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


def effects_page() -> str:
    """The effects, computed and judged, as Markdown."""
    scene = fm.Scene.from_toml(SCENES / "olsson_plate.toml")
    known = {effect.name: effect for effect in effects_of(scene)}
    computed = "\n".join(
        f"| `{name}` | {what} | {known[name].indicator} | {known[name].source} |" for name, what in COMPUTED.items()
    )
    rules = {name: rule for name, rule in RULES.items() if name not in COMPUTED}
    judged = "\n".join(
        f"## {name.replace('_', ' ')}\n\n{inspect.cleandoc(rule.__doc__ or '')}\n\n"
        f"Indicator: {indicator}. Source: {source}.\n"
        for name, (indicator, source, rule) in rules.items()
    )
    reflections = inspect.cleandoc(RULES["boundary_reflections"][2].__doc__ or "")
    return f"""# Effects

Made from the code by `python examples/reference_pages.py`. Each effect of a scene has an indicator with its value and
the threshold from which it matters, what leaving it out would change, and a state: simulated, not needed, switched off
(by the scene), needed but not modelled (a warning in every output), or not judged (the scene does not say enough).
"Changes" is the largest relative difference of the summary: of force, indentation and times against their own values,
of the dent against the largest indentation, of velocities against the approach velocity, of energies against the impact
energy. An effect matters if it changes more than `tolerance` in `[effects]` (1 %, or the accuracy if that is coarser).

# Computed

Tried on a coarse mesh, with the effect and without. `true`, `false` or `"auto"` in `[effects]` decides for all of them
but `fully_plastic`, which comes with the contact law.

| effect | | indicator | decided by |
|---|---|---|---|
{computed}

Boundary reflections. {reflections}

# Judged

What is not simulated: first-order estimates, right in size, not in the second digit.

{judged}
# An example

`film-model explain examples/scenes/olsson_plate.toml`:

```
{effects_text(scene)}
```
"""


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
    pages = {"laws.md": laws_page(), "effects.md": effects_page()}
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")
    plot_laws(folder / "laws.png", dpi=80.0)
    return [folder / name for name in (*pages, "laws.png")]


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:])):
        print(path)
