"""The page docs/reference/scene_file.md: every key of a scene file, from the tables `FIELDS`."""

import inspect
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from examples.reference.markdown import MADE, table, words
from film_model.base.fields import Field
from film_model.base.materials import MOST_RELAXATIONS, MOST_RELAXED, Material
from film_model.base.units import DIMENSIONS, scene_unit
from film_model.scene import Contact, Effects, Solver, Sphere
from film_model.scene.contact import UNLOADINGS
from film_model.targets import TARGETS, BendingStiffness
from film_model.targets.layup import PlyMaterial

_SAID_ELSEWHERE = re.compile(
    r"(^|, )(m|m²|kg|kg/m²|kg/m³|Pa|Pa·s|N·m|N/m|N/m²|N/m³|m/s|rad|Hz|J/m²|N·s/m|m/N|1/s|Pa·m\^0\.5)(?=[;,]|$)"
    r"|; or, to the constructor, diameter|^dimensionless$"
)
"""Units, which the other columns show, and what concerns Python only."""

EXAMPLES = {
    "shape": '"shell"',
    "half_angle": '"70 deg"',
    "friction": "0.2",
    "roughness": '"0.8 um"',
    "fluid_viscosity": '"1 mPa*s"',
    "spin": '"3000 rpm"',
    "velocity": '"2 m/s"',
    "drop_height": '"500 mm"',
    "material": '"mild steel"',
    "effective_modulus": '"115 GPa"',
    "yield_strength": '"250 MPa"',
    "tensile_strength": '"45 MPa"',
    "fracture_toughness": '"0.7 MPa*m^0.5"',
    "crushing_strength": '"38 MPa"',
    "E2": '"10 GPa"',
    "G12": '"7 GPa"',
    "name": '"our steel"',
    "source": '"data sheet"',
    "loss_factor": "0.01",
    "hardness": '"200 HV"',
    "strain_rate_coefficient": "0.02",
    "strain_hardening_exponent": "0.1",
    "strength_coefficient": '"275 MPa"',
    "strength_exponent": "0.36",
    "rate_multiplier": '"40 s^-1"',
    "rate_exponent": "5",
    "law": '"stronge"',
    "unloading": '"brake"',
    "plasticity": "false",
    "target_motion": "false",
    "gravity": "true",
    "boundary_reflections": "false",
    "target_inertia": "false",
    "rate_hardening": "false",
    "viscoelasticity": "false",
    "material_damping": "false",
    "wave_losses": "false",
    "small_slope": "false",
    "prony": '[[0.3, "1 ms"], [0.2, "20 ms"]]',
    "tolerance": "0.05",
    "accuracy": "1e-6",
    "segments": "5",
    "linearisation": '"chord"',
    "bending_stiffness": '{ D11 = "155 N*m", D12 = "45 N*m", D22 = "155 N*m", D66 = "55 N*m" }',
    "D12": '"45 N*m"',
    "layup": '[["carbon/epoxy UD", "2 mm", 0], ["carbon/epoxy UD", "3 mm", 90], ["carbon/epoxy UD", "2 mm", 0]]',
    "size": '["300 mm", "200 mm"]',
    "edges": '"clamped"',
    "edge_stiffness": '"2e6 N/m^2"',
    "in_plane": '"fixed"',
    "stretching": "false",
    "damping_ratio": "0.01",
    "position": '"100 mm"',
    "Plate.position": '["100 mm", "50 mm"]',
    "impedance_formula": '"paper"',
    "ends": '["clamped", "free"]',
    "theory": '"timoshenko"',
    "Plate.theory": '"mindlin"',
    "far_end": '"fixed"',
    "file": '"modes.csv"',
    "frequency": '["180 Hz", "410 Hz"]',
    "modal_mass": '["0.9 kg", "1.4 kg"]',
    "sensors": '[{ name = "tip", position = "80 mm" }]',
    "Plate.sensors": '[{ name = "corner", position = ["10 mm", "20 mm"], strain = true }]',
    "Structure.sensors": '[{ name = "tip", shape = "shape_17" }]',
}
"""Examples of keys for which that of their dimension does not serve."""


def meanings(owner: type) -> dict[str, str]:
    """What each field means: the class's docstring has "name: meaning." for each."""
    text = " ".join(inspect.cleandoc(owner.__doc__ or "").partition("\n>>>")[0].split())
    names = "|".join([*owner.FIELDS, "parameters"])
    found = list(re.finditer(rf"(?:(?<=[.;,] )|(?<=or )|(?<=and )|^)({names}): ", text))
    ends = [match.start() for match in found[1:]] + [len(text)]
    cut = {match[1]: text[match.end() : end] for match, end in zip(found, ends, strict=True)}
    plain = {name: re.sub(r"[;,.]?\s*(or|and)?\s*$", "", what) for name, what in cut.items()}
    return {name: _meaning(name, _SAID_ELSEWHERE.sub("", what).lstrip("; ,")) for name, what in plain.items()}


def _meaning(name: str, what: str) -> str:
    if what and not what.startswith(("default", "none", "without", "positive", "used")):
        return what
    spaced = {"youngs_modulus": "Young's modulus", "poissons_ratio": "Poisson's ratio"}.get(
        name, name.replace("_", " ")
    )
    return f"{spaced}; {what}" if what else spaced


def keys(owner: type) -> str:
    """The table of the keys that a class reads."""
    what, signature = meanings(owner), inspect.signature(owner.__init__).parameters
    fields: Mapping[str, Field] = owner.FIELDS
    rows = []
    for name, field in fields.items():
        default = _default(field, signature[name].default)
        rows.append((f"`{name}`", what[name], f"`{example(owner, name)}`", _allowed(name, field), default))
    return table(("key", "meaning", "example", "allowed", "default"), rows)


def example(owner: type, name: str) -> str:
    """An example of a key as a scene file has it; the key's own reader has accepted it."""
    field: Field = owner.FIELDS[name]
    shown = EXAMPLES.get(f"{owner.__name__}.{name}", EXAMPLES.get(name))
    if shown is None:
        shown = DIMENSIONS[field.dimension].example
        shown = shown if field.dimension == "dimensionless" else f'"{shown}"'
    if name != "file":
        field.read(tomllib.loads(f"x = {shown}")["x"])
    return shown


def _allowed(name: str, field: Field) -> str:
    """The range of a number, or the words that are allowed."""
    if name == "prony":
        return f"1 to {MOST_RELAXATIONS} pairs; moduli together below {MOST_RELAXED:g}, times 1e-12 to 1e+12 s"
    if name == "law":
        return '`"auto"` or the name of a [law](../laws.md)'
    if name == "unloading":
        return words(UNLOADINGS)
    if field.need.startswith('"'):
        need = field.need.replace(" is needed", "").replace("true or false", "`true` or `false`")
        return re.sub(r'("[^"]+")', r"`\1`", need)
    return _range(field)


def _range(field: Field) -> str:
    if field.low is None or field.high is None:
        return ""
    unit = scene_unit(field.dimension)
    low, high = f"{field.low:g}", f"{field.high:g} {unit}".rstrip()
    return f"between {low} and {high}" if field.open_ends else f"{low} to {high}"


def _default(field: Field, default: Any) -> str:
    if default is None or default is inspect.Parameter.empty:
        return "required" if field.required else ""
    return "" if default == "" else f"`{str(default).lower() if isinstance(default, bool) else default}`"


def scene_page() -> str:
    """Every section and key of a scene file."""
    targets = "\n".join(f'### `kind = "{kind}"`\n\n{keys(target)}' for kind, target in TARGETS.items())
    return f"""# Scene file

{MADE}A scene is a TOML file; `film-model new` writes a commented one. A quantity is a text with any unit of the right
dimension (`"10 mm"`, `in`, `mph`, `lb`, `ksi`, …), a number only where the table shows one. `[impactor]` and `[target]`
are required, `title = "…"` at the top is optional. All mistakes are reported at once, each with its line.

## `[impactor]`

{keys(Sphere)}
Give `velocity` or `drop_height`. `diameter` may replace `radius`.

## `[target]`

`kind` selects the other keys: {words(TARGETS)}. In a free body
`diameter` may replace `radius`. [Structures](../structures.md) explains edges, layups and vibrations.

{targets}
### `[target.bending_stiffness]`

{keys(BendingStiffness)}
### Layers: `layup`

Each layer is `["carbon/epoxy UD", "0.125 mm", 45]`, the angle in degrees; the material is a name or a table:

{keys(PlyMaterial)}
## Materials

`material` is a name of the catalogue (`film-model materials`) or a table, `[impactor.material]` or `[target.material]`:

{keys(Material)}
## `[contact]`

{keys(Contact)}
The parameters of a law are keys of this section, too: [Contact laws](../laws.md).

## `[effects]`

`"auto"` simulates an effect if it matters: [Effects](../effects.md).

{keys(Effects)}
## `[solver]`

{keys(Solver)}
Give `accuracy` or `segments`; `accuracy = 1e-4` is the default.
"""
