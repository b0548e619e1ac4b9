"""The names that docs/reference/stability.md promises to keep; run as a program, stores them in public_names.json."""

import argparse
import contextlib
import inspect
import io
import json
import re
import sys
import tempfile
import warnings
from enum import Enum
from pathlib import Path

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_datasets.schema import ATTRIBUTES, CONSTANTS, TABLE, VERSIONS
from film_datasets.sweeps.designs import DESIGNS
from film_datasets.sweeps.distributions import DISTRIBUTIONS
from film_model.base.materials import catalogue
from film_model.cli.main import COMMANDS, main, parser
from film_model.effects.effect import COMPUTED
from film_model.effects.judged import RULES
from film_model.laws import LAWS
from film_model.laws.unloading import UNLOADINGS
from film_model.solve.history import SUMMARY
from film_model.targets import TARGETS
from film_model.targets.layup import PlyMaterial
from fmu_wrapper.variables import EVENT_KINDS, PHASES, SLIDINGS, VARIABLES

STORED = Path(__file__).with_suffix(".json")
PAGE = Path(__file__).parents[1] / "docs" / "reference" / "python.md"
LISTED = re.compile(r"autoclass:: (\w+)\.(\w+)\n(?: +:members:(.*)\n)?")
RESULTS = {fm.BatchResult, fm.Bounces, fm.Derivatives, fm.Event, fm.History, fm.Samples, fd.Film, fd.Identification}
RESULTS |= {fd.Score, fd.Tolerance, fd.Variable, fmu_wrapper.Package, fmu_wrapper.Report}
"""Classes whose objects functions return: how they are constructed is not promised, but their fields are."""

BALL = """[target]
kind = "half-space"
material = "mild steel"
[impactor]
radius = "10 mm"
velocity = "1 m/s"
material = "bearing steel"
"""
OBLIQUE = BALL + 'angle = "30 deg"\n[contact]\nfriction = 0.2\n'
DAMPED = BALL + '[contact]\nlaw = "tsuji"\nrestitution = 0.5\n'


def names() -> dict[str, list[str]]:
    """The promised names by group, each as a text."""
    found = {
        "python": {*_python()},
        "scene file": _scene_keys(),
        "sweep file": {*DESIGNS, *DISTRIBUTIONS},
        "materials": set(catalogue()),
        "command line": {text for commands in COMMANDS.values() for name in commands for text in _options(name)},
        "json": _reports(),
        "datasets": {f"{kind}: {v.name}" for kind, table in TABLE.items() for v in table}
        | {f"scalar: {v.name}" for v in CONSTANTS}
        | {f"{kind}: attribute {name}" for kind, attributes in ATTRIBUTES.items() for name in attributes}
        | {f"{kind}: schema {version.partition('.')[0]}" for kind, version in VERSIONS.items()},
        "fmu": {f"{kind} {v.name} ({what}, {v.dimension})" for v in VARIABLES for kind, what in v.causality.items()}
        | {f"phase {code} {name}" for code, name in enumerate(PHASES)}
        | {f"event {code} {name}" for code, name in enumerate(EVENT_KINDS)}
        | {f"sliding {code} {name}" for code, name in enumerate(SLIDINGS)},
    }
    return {group: sorted(texts) for group, texts in found.items()}


def _python():
    """Public names, their parameters, fields of results, and the members that the reference page lists."""
    for face in (fm, fd, fmu_wrapper):
        for name in face.__all__:
            yield f"{face.__name__}.{name}"
            yield from _parameters(f"{face.__name__}.{name}", getattr(face, name))
    yield from (f"film_model.Outcome.{one.name}" for one in fm.Outcome)
    yield from (f"film_model.History.{name}" for name in SUMMARY)
    for package, name, members in LISTED.findall(PAGE.read_text(encoding="utf-8")):
        thing = getattr(sys.modules[package], name)
        named = members.split(",") if members else (*vars(thing), *thing.__annotations__) if thing in RESULTS else ()
        for member in filter(lambda one: one and one[0] != "_", map(str.strip, named)):
            yield f"{package}.{name}.{member}"
            yield from _parameters(f"{package}.{name}.{member}", getattr(thing, member, None))


def _parameters(full, thing):
    """Parameters that have a place, with it, and those that have a name only."""
    if not callable(thing) or (inspect.isclass(thing) and (thing in RESULTS or issubclass(thing, (Exception, Enum)))):
        return
    kinds = inspect.Parameter
    for place, (name, parameter) in enumerate(inspect.signature(thing).parameters.items()):
        if parameter.kind is kinds.KEYWORD_ONLY:
            yield f"{full}({name}=)"
        elif name != "self" and parameter.kind is kinds.POSITIONAL_OR_KEYWORD:
            yield f"{full}({place}: {name})"


def _scene_keys():
    owners = {
        "impactor": fm.Sphere,
        "contact": fm.Contact,
        "effects": fm.Effects,
        "solver": fm.Solver,
        "ply": PlyMaterial,
    }
    owners |= {"material": fm.Material, "bending_stiffness": fm.BendingStiffness}
    owners |= {f"target {kind}": target for kind, target in TARGETS.items()}
    laws = {f"law {name}": law for name, law in LAWS.items()} | {
        f"unloading {name}": r for name, r in UNLOADINGS.items()
    }
    return {
        *(f"{section}.{key}" for section, owner in owners.items() for key in owner.FIELDS),
        *laws,
        *(f"{name}.{key}" for name, law in laws.items() for key in law.parameters),
        *(f"effect {name}" for name in {**COMPUTED, **RULES}),
    }


def _options(command):
    (sub,) = (a.choices[command] for a in parser(command)._actions if isinstance(a, argparse._SubParsersAction))
    yield command
    for action in sub._actions:
        yield from (f"{command} {option}" for option in action.option_strings or [action.dest])


def _reports():
    """Keys of the commands' --json."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("oblique", OBLIQUE), ("damped", DAMPED)):
            Path(folder, name).write_text(text, encoding="utf-8")
        scenes = (("run", "oblique"), ("run", "damped"), ("bounce", "damped"), ("explain", "oblique"))
        commands = [(command, str(Path(folder, name))) for command, name in scenes]
        return {text for command in (*commands, ("laws",), ("materials",)) for text in _report(*command)}


def _report(command, *arguments):
    written = io.StringIO()
    with contextlib.redirect_stdout(written), contextlib.redirect_stderr(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if main([command, *arguments, "--json"]) != 0:
            raise RuntimeError(f"{command} fails")
    return {f"{command}: {path}" for path in _paths(json.loads(written.getvalue()))}


def _paths(value, at=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _paths(inner, f"{at}.{key}".lstrip("."))
    elif isinstance(value, list) and any(isinstance(inner, dict) for inner in value):
        for inner in value:
            yield from _paths(inner, f"{at}[]")
    else:
        yield at


if __name__ == "__main__":
    STORED.write_text(json.dumps(names(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
