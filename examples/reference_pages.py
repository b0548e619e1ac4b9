"""Write docs/laws.md, docs/laws.png, docs/effects.md, docs/reference and the README's list of laws from the code."""

import inspect
import re
import sys
from pathlib import Path

import film_model as fm
from examples.effects_compared import compared
from examples.reference.files_and_commands import command_page, csv_page, sweep_page
from examples.reference.scene_file import scene_page
from examples.reference.variables import dataset_page, fmu_page
from film_model.effects import large_slope, rate_hardening, viscoelasticity, wave_losses
from film_model.effects.choose import choose
from film_model.effects.effect import COMPUTED
from film_model.effects.judged import RULES
from film_model.effects.material_rules import material_damping
from film_model.laws import LAWS, AbstractLaw, Parameter
from film_model.laws.law import FAMILIES, SCENE_FIELDS, law_fields
from film_model.laws.unloading import UNLOADINGS
from film_model.plot import plot_laws
from film_model.studies.explain import effects_text
from film_model.targets import TARGETS, AbstractTarget

DOCS, SCENES = Path(__file__).parents[1] / "docs", Path(__file__).parent / "scenes"
README = DOCS.parent / "README.md"
FORMULAS = re.compile(r"(?:^ {4}.*(?:\n|$))+", re.MULTILINE)
MARKED = re.compile(r"(<!-- laws: .*? -->\n).*?(<!-- end of laws -->)", re.DOTALL)


def families() -> str:
    """The names of the laws by family, as a Markdown list."""
    lines = [
        f"- {heading}: " + ", ".join(f"`{name}`" for name, law in LAWS.items() if law.family == family)
        for family, heading in FAMILIES.items()
    ]
    return "\n".join(lines) + "\n"


def laws_page() -> str:
    """The laws and the rules of unloading as Markdown."""
    rows = "\n".join(f"| [`{name}`](#{name}) | {law.summary} | {law.source} |" for name, law in LAWS.items())
    laws = "\n".join(_section(name, law) for name, law in LAWS.items())
    rules = "\n".join(_section(name, law, "###") for name, law in UNLOADINGS.items())
    return f"""# Contact laws

`law = "…"` in a scene's `[contact]` names the law, beside its parameters. δ: indentation, F: contact force,
E, R: effective modulus and radius, K = (4/3) E √R: Hertz's stiffness; w of adhesive laws: `work_of_adhesion` of both
surfaces together.

![One impact under every law](laws.png)

| law | | source |
|---|---|---|
{rows}

{laws}
## Rules of unloading

`unloading = "…"` in `[contact]` replaces the unloading of a law without damping.

{rules}"""


def effects_page() -> str:
    """The effects, computed and judged, as Markdown."""
    scene = fm.Scene.from_toml(SCENES / "olsson_plate.toml")
    known = {effect.name: effect for effect in choose(scene).effects}
    computed = "\n".join(
        f"| `{name}` | {what} | {known[name].indicator} | {known[name].source} |" for name, what in COMPUTED.items()
    )
    rules = {name: rule for name, rule in RULES.items() if name not in COMPUTED}
    given = {n: getattr(AbstractTarget, rule) if isinstance(rule, str) else rule for n, (_, rule) in rules.items()}
    texts = {name: _shown(rule.__doc__).partition("\n\n") for name, rule in given.items()}
    texts = {name: (what.rstrip("."), f"{how}\n\n{_by_target(name)}".strip()) for name, (what, _, how) in texts.items()}
    judged = "\n\n".join(f"### {name.replace('_', ' ')}\n\n{how}" for name, (_, how) in texts.items() if how)
    sources = "\n".join(
        f"| `{n}` | {texts[n][0]} | {rule.indicator} | {rule.source} |" for n, (rule, _) in rules.items()
    )
    return f"""# Effects

`film-model explain` has a line for each effect of your scene; `--verbose` adds indicator, threshold and source. An
effect is simulated, not needed, switched off by the scene, needed but not modelled (a warning in every output), or not
judged because the scene lacks data. It matters if the error if neglected, the largest change of a summary value,
exceeds `tolerance` in `[effects]` (1 %, or the accuracy if that is larger):

| change of | relative to |
|---|---|
| force, indentation, times | themselves |
| dent | maximum indentation |
| velocities | approach velocity |
| energies | impact energy |

## Computed

The impact is simulated on a coarse mesh with the effect and without it. `[effects]` selects each with `true`, `false`
or `"auto"`, except `fully_plastic`, which is part of the law.

| effect | | indicator | decided by |
|---|---|---|---|
{computed}

{_shown(rate_hardening.__doc__)}

{_shown(viscoelasticity.__doc__)}

{_shown(material_damping.__doc__)}

{_shown(large_slope.__doc__)}

{_shown(wave_losses.__doc__)}

{_by_target("wave_losses")}Boundary reflections:

{_by_target("boundary_reflections")}## Judged

Estimated to first order: the order of magnitude.

| effect | | indicator | source |
|---|---|---|---|
{sources}

{judged}

## Compared

`examples/effects_compared.py` finds these numbers without the package's estimates.

{compared()}
## An example

`film-model explain examples/scenes/olsson_plate.toml`:

```
{effects_text(scene)}
```
"""


def _by_target(effect: str) -> str:
    """How each kind of target judges an effect, a paragraph each; kinds that do it alike in one."""
    method = RULES[effect][1]
    kinds: dict[str, list[str]] = {}
    for kind, target in TARGETS.items():
        if isinstance(method, str) and method in vars(target):
            kinds.setdefault(_shown(vars(target)[method].__doc__), []).append(kind)
    return "".join(f"**{', '.join(names)}** — {text}\n\n" for text, names in kinds.items())


def _section(name: str, law: type[AbstractLaw], heading: str = "##") -> str:
    from_scene = ", ".join(f"`{key}`" for key in law_fields(law) if key in SCENE_FIELDS)
    rows = [f"| `{key}` | {_parameter(value)} |" for key, value in law.parameters.items()]
    rows += [f"| from the scene | {from_scene} |"] if from_scene and name in LAWS else []
    rows += [f"| valid | {law.validity} |"]
    table = "\n".join(["| parameter | |", "|---|---|", *rows])
    return f"{heading} {name}\n\n{_shown(law.__doc__, law.source)}\n\n{table}\n"


def _shown(docstring: str | None, source: str = "") -> str:
    """A docstring as Markdown, without the source that it begins with; indented formulas as code."""
    text = inspect.cleandoc(docstring or "").removeprefix(f"{source}.").removeprefix(" ").strip("\n")
    return FORMULAS.sub(lambda found: f"```text\n{inspect.cleandoc(found[0])}\n```\n", text)


def _parameter(parameter: Parameter) -> str:
    kind = " or ".join(f"`{choice}`" for choice in parameter.choices) or parameter.dimension.replace("_", " ")
    kind = f"a list, each a {kind}" if parameter.several else kind
    return f"{parameter.help} ({kind}{'' if parameter.required else ', optional'})"


PAGES = {
    "laws.md": laws_page,
    "effects.md": effects_page,
    "reference/scene_file.md": scene_page,
    "reference/sweep_file.md": sweep_page,
    "reference/csv_files.md": csv_page,
    "reference/command_line.md": command_page,
    "reference/fmu_variables.md": fmu_page,
    "reference/dataset_variables.md": dataset_page,
}


def main(folder: Path = DOCS, readme: Path = README) -> list[Path]:
    """Write the pages, the picture, and the list of laws in the README; returns the paths."""
    for name, page in PAGES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(page(), encoding="utf-8")
    plot_laws(folder / "laws.png", dpi=80.0)
    text = MARKED.sub(lambda match: match[1] + families() + match[2], readme.read_text(encoding="utf-8"))
    readme.write_text(text, encoding="utf-8")
    return [*(folder / name for name in (*PAGES, "laws.png")), readme]


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:])):
        print(path)
