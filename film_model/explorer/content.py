"""What the page is made of besides its text: the recorded formulas, and one table of data."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.polynomial import chebyshev

from film_model.base.arrays import AGREEMENT
from film_model.base.errors import STATUSES, Outcome, SimulationError
from film_model.base.materials import catalogue
from film_model.base.unit_symbols import SYMBOLS, parse_unit
from film_model.base.units import DIMENSIONS, PREFIXED, scene_unit, si_unit
from film_model.core import friction, modal, native, refining, springs
from film_model.core.solving import MOST_SEGMENTS
from film_model.effects.choose import Choice, choose
from film_model.effects.effect import percent
from film_model.effects.rate_hardening import MOST_ROUNDS
from film_model.explorer import formulas, friction_formulas, plain_formulas, support
from film_model.explorer.formulas import LEAST_RESTITUTION
from film_model.explorer.inputs import STRENGTH_ENTRIES, in_place_of, inputs_of, plate_inputs, with_exponents
from film_model.explorer.laws import laws_of
from film_model.oblique import friction as oblique
from film_model.oblique import springs as rows
from film_model.oblique.result import KINDS as PHASES
from film_model.oblique.result import OBLIQUE, REGIMES
from film_model.plot import strobe
from film_model.plot.style import COLOURS
from film_model.problem.curve import TRIAL_SEGMENTS
from film_model.problem.families import TERMS, mean_matrix, series_matrix
from film_model.problem.law_of_scene import DAMPED, ELASTIC, STEEP, YIELDING
from film_model.problem.model_intervals import (
    COVERED,
    KINDS,
    LARGEST,
    evidence,
    missing,
    residuals_of,
)
from film_model.problem.summary import SUMMARY
from film_model.scene import DEFAULT_ACCURACY, DEFAULT_TOLERANCE, Scene, Sphere
from film_model.scene.friction_table import FrictionTable
from film_model.solve.accuracy import FIRST_SEGMENTS
from film_model.solve.history import MOTION
from film_model.solve.simulate import simulate_chosen
from film_model.studies.regimes import limits, regimes
from film_model.targets import HalfSpace, Plate
from film_model.targets.supports import SUPPORTS
from film_model.version import __version__

SWITCHES = (
    "plasticity",
    "target_motion",
    "gravity",
    "rate_hardening",
    "material_damping",
    "wave_losses",
    "small_slope",
)
"""Effects that the page decides again for every change, by the same formulas."""


EDGES = ("boundary_reflections", "target_inertia")
"""The same for plates whose motion between edges the page computes."""


class Content:
    """The formulas and data of a page with these scenes, by name."""

    def __init__(self, scenes: Iterable[tuple[str, Scene]]) -> None:
        self._functions: dict[str, str] = {}
        self._curves: dict[bytes, int] = {}
        self._laws: dict[str, tuple[int, dict[str, Any]]] = {}
        self._scenes = [self._scene(name, scene) for name, scene in scenes]
        free, fixed = _samples()
        texts = [*formulas.result_functions("Free", free), *formulas.result_functions("Fixed", fixed)]
        texts += [*formulas.vibrating_functions(fixed), *friction_formulas.common_functions(fixed)]
        texts += [formulas.warning_function(fixed), *formulas.hardening_functions(fixed)]
        texts += [formulas.gravity_function(fixed), *plain_formulas.plain_functions()]
        self._functions |= {text: text for text in texts}

    @property
    def script(self) -> str:
        """The recorded formulas as JavaScript."""
        any_object = "/** @type {Record<string, (...values: any[]) => Record<string, any>>} */\n"
        names = ", ".join(text.removeprefix("function ").partition("(")[0] for text in self._functions.values())
        return "\n".join([*self._functions.values(), f"{any_object}const FORMULAS = {{ {names} }};", ""])

    @property
    def curves(self) -> bytes:
        """The laws' curves, one after the other."""
        return b"".join(self._curves)

    def table(self) -> dict[str, Any]:
        """The data, for JSON."""
        return {
            "version": __version__,
            "scenes": self._scenes,
            "laws": [table for _, table in self._laws.values()],
            "materials": {
                name: {"youngs_modulus": m.youngs_modulus, "poissons_ratio": m.poissons_ratio, "density": m.density}
                | {
                    n: v
                    for n in (*STRENGTH_ENTRIES, "strain_rate_coefficient", "loss_factor")
                    if (v := getattr(m, n)) is not None
                }
                for name, m in catalogue().items()
            },
            "units": {symbol: [float(size), list(powers)] for symbol, (size, powers) in SYMBOLS.items()},
            "dimensions": {name: _dimension(name) for name in DIMENSIONS},
            **{"summary": SUMMARY, "motion": MOTION, "oblique": OBLIQUE},
            "statuses": {str(code): status.sentence for code, status in STATUSES.items()},
            "colours": COLOURS,
            "series": {"points": chebyshev.chebpts1(TERMS).tolist()}
            | {"force": series_matrix(TERMS).tolist(), "mean": mean_matrix().tolist()},
            "map": regime_map(),
            "intervals": _intervals(),
            "layout": layout(),
            "edges": SUPPORTS,
            "plate_ways": support.plate_ways(),
            "constants": _constants(),
        }

    def _scene(self, name: str, scene: Scene) -> dict[str, Any]:
        """A scene with what was decided for it."""
        if not scene.is_round:
            raise SimulationError("the page shows contacts of balls, and this is another: use film-model run")
        scene = with_exponents(scene)
        choice = choose(scene)
        if not choice.problem.approach > 0.0:
            raise SimulationError("the impactor has no velocity: there is no impact to show on a page")
        computed, why = support.computed(scene.target), not_simulated(choice)
        held, reason = (None, why) if why or computed else support.data(choice)
        inputs = list(inputs_of(scene))
        if held is not None:
            scene = support.fixed_to(choice)
            inputs = [entry for entry in inputs if support.may_change(entry.path, held)]
            inputs += support.damping_of(scene.target) if held["modes"] else []
        paths = [entry.path for entry in inputs]
        target = scene.target
        plate = None
        if computed:
            beside = plate_inputs(cast("Plate", target))
            inputs += beside
            functions = formulas.plate_functions(scene, [*paths, *(entry.path for entry in beside)])
            plate = {name: self._named(text) for name, text in functions.items()}
        reflected = None
        infinite = held is None and plate is None and target.structural and target.finite
        if infinite and hasattr(target, "reflection_change"):
            reflected = self._named(formulas.reflections_function(scene, paths))
        effects = scene.effects
        return {
            "name": name,
            "title": scene.title or f"Impact on a {target.kind}",
            "kind": target.kind,
            "free": target.free,
            "table": scene.to_table(),
            "inputs": [entry.to_dict() for entry in inputs],
            "numbers": self._named(formulas.numbers_function(scene, paths)),
            "reflections": reflected,
            "along": self._along(scene, paths),
            "laws": [self._law(found, scene) for found in laws_of(scene)],
            "plain": self._plain(scene),
            "law": scene.contact.law_name,
            "plate": plate,
            "effects": {switch: getattr(effects, switch) for switch in (*SWITCHES, *(EDGES if plate else ()))},
            "edges": effects.boundary_reflections,
            "support": held and held | {"key": name},
            "tolerance": effects.tolerance,
            "solver": {key: getattr(scene.solver, key) for key in ("accuracy", "segments", "linearisation")},
            "given": given(choice, reason) if reason else None,
            "judged": [{key: getattr(e, key) for key in ("name", "state", "change", "reason")} for e in choice.effects],
            "warnings": list(choice.warnings),
            "replaced": in_place_of(inputs),
            "moduli": {
                body: part.material.youngs_modulus
                for body, part in (("impactor", scene.impactor), ("target", scene.target))
                if part.material is not None
            },
        }

    def _along(self, scene: Scene, paths: list[str]) -> dict[str, str] | None:
        """The functions of an impact with friction; None if the page has none for these bodies."""
        if "contact.friction" not in paths:
            return None
        return {name: self._named(text) for name, text in friction_formulas.friction_functions(scene, paths).items()}

    def _plain(self, scene: Scene) -> list[int]:
        """The scene's law without its rule of unloading, which holds for no other choice of the law."""
        law = scene.contact.law_name
        if scene.contact.unloading is None or law not in (ELASTIC, YIELDING):
            return []
        other = scene.replace({"contact.law": "auto", "contact.unloading": None})
        return [self._law(found, other) for found in laws_of(other, [law])]

    def _law(self, found: Any, scene: Scene) -> int:
        """The place of a law in the list of laws."""
        curve = self._curves.setdefault(found.embedded, len(self._curves))
        table = found.to_dict(self._named(found.function(scene)), curve)
        table["example"] = self._named(found.example) if found.derived else None
        if table["shape"] is not None:
            shape, values = formulas.shape_functions(found.law, found.fixed)
            named = {"function": self._named(shape), "values": self._named(values)}
            table["shape"] |= named
        return self._laws.setdefault(repr(table), (len(self._laws), table))[0]

    def _named(self, text: str) -> str:
        """The name of a function, with a number; functions with the same body are kept once."""
        head, _, body = text.partition("(")
        if body not in self._functions:
            self._functions[body] = f"{head}{len(self._functions)}({body}"
        return self._functions[body].removeprefix("function ").partition("(")[0]


def not_simulated(choice: Choice) -> str:
    """Why the page cannot simulate the contact of the scene; empty if it can."""
    if choice.problem.relaxation is not None:
        return "a material is viscoelastic"
    return f"the law {choice.problem.law.name} pulls" if choice.problem.curve.pulls else ""


def given(choice: Choice, reason: str) -> dict[str, Any]:
    """The result of an impact that the page cannot simulate."""
    history = simulate_chosen(choice, choice.scene.solver)
    samples = history.sample_si(np.linspace(0.0, history.duration, 201))
    motion = {name: getattr(samples, name).tolist() for name in ("time", *MOTION)}
    return {
        "reason": reason,
        "summary": dict(history.summary),
        "error": history.accuracy.estimated,
        "segments": history.accuracy.lines,
        "law": choice.problem.law.name,
        "ended": history.outcome is Outcome.SEPARATED,
        "motion": {name: [float(f"{value:.7g}") for value in values] for name, values in motion.items()},
        "stage": samples.stage.tolist(),
        "warnings": list(history.remarks),
    }


def _samples() -> list[Scene]:
    """A scene with a free target, and one with another."""
    ball = {"radius": "1 mm", "velocity": "1 m/s", "material": "mild steel"}
    other = {"kind": "body", "radius": "1 mm", "material": "mild steel"}
    tables = ({"impactor": ball, "target": other}, {"impactor": ball, "target": {"kind": "half-space"}})
    contact = {"effective_modulus": "1 GPa"}
    return [Scene.from_table(table | {"contact": contact}) for table in tables]


def _dimension(name: str) -> dict[str, Any]:
    unit = si_unit(name)
    powers = (0, 0, 0) if name == "dimensionless" else parse_unit(unit)[1]
    return {"unit": scene_unit(name), "cf": unit, "powers": list(powers), "prefixed": name in PREFIXED}


@cache
def regime_map() -> list[dict[str, Any]]:
    """The boundaries of the map of regimes; its two numbers say everything, so they are the same for all scenes."""
    found = limits(regimes(Scene(Sphere("1 mm", "1 m/s", material="alumina"), HalfSpace("alumina"))), DEFAULT_TOLERANCE)
    words = ("yields", "fully plastic", f"target motion changes {percent(DEFAULT_TOLERANCE)}")
    return [
        {"name": word, "x": [x for x, _ in line], "y": [y for _, y in line]}
        for word, line in zip(words, found, strict=True)
    ]


def _intervals() -> list[list[dict[str, Any]]]:
    """For each family of `KINDS`: how far measured values lie from those of law "auto", or why there are too few."""
    found: list[list[dict[str, Any]]] = []
    for family in KINDS:
        known = {name: residuals_of(family, name) for name in SUMMARY}
        found.append(
            [
                {
                    **{"name": name, "low": one.low, "high": one.high, "most": one.most, "up_to": f"{one.most:.0f}"},
                    **{"covered": COVERED, "largest": LARGEST.get(name), "evidence": evidence(family, one)},
                }
                for name, one in known.items()
                if one is not None
            ]
            + [{"name": name, "missing": said} for name in SUMMARY if (said := missing(family, name))]
        )
    return found


WHOLE = native.Summary, refining.Run, refining.Refinement
"""Structures that the page reads and writes by the names of their numbers, among them integers."""


def layout() -> dict[str, Any]:
    """Sizes and offsets of the core's structures, in bytes; without pointers they are the same on all platforms."""
    structures: dict[str, Any] = {
        **{"start": native.Start, "summary": native.Summary, "state": native.State, "line": native.Line},
        **{"solution": native.Solution, "modal": modal.Modal, "modal_start": modal.Start},
        **{
            "modal_summary": modal.Summary,
            "run": refining.Run,
            "refine": refining.Refinement,
            "modal_segment": modal.Segment,
            "modal_event": modal.Event,
        },
        **{"normal": friction.Normal, "friction": friction.Result, "springs": springs.Impact, "watch": springs.Watch},
    }
    found: dict[str, Any] = {
        name: {field[0]: getattr(kind, field[0]).offset for field in kind._fields_} | {"size": ctypes.sizeof(kind)}
        for name, kind in structures.items()
    }
    return found | {
        "curve": ctypes.sizeof(native.Curve),
        "most_segments": MOST_SEGMENTS,
        "events": native.EVENTS,
        "asks": refining.ASKS,
        "whole": [own[0] for kind in WHOLE for own in kind._fields_ if own[1] is ctypes.c_int32],
        "levels": modal.LEVELS,
    }


def _constants() -> dict[str, Any]:
    return {
        "first_segments": FIRST_SEGMENTS,
        "trial_segments": 4 * TRIAL_SEGMENTS,  # the page marches lines only; the trial in Python takes shorter ways
        "most_rounds": MOST_ROUNDS,
        **{"agreement": AGREEMENT, "accuracy": DEFAULT_ACCURACY},
        **{
            "elastic": ELASTIC,
            "yielding": YIELDING,
            "damped": DAMPED,
            "steep": STEEP,
        },
        "least_restitution": LEAST_RESTITUTION,
        "vibration": support.constants(),
        "ritz": support.ritz_constants(),
        "friction": _friction(),
    }


def _friction() -> dict[str, Any]:
    """The numbers of :mod:`film_model.oblique` and of the strobe picture."""
    return {
        **{"springs": rows.SPRINGS, "closed": oblique.CLOSED, "regimes": REGIMES, "phases": PHASES},
        "fastest": FrictionTable.PAIR[0].high,
        **support.numbers_of(strobe, ("BALLS", "SPACING")),
    }
