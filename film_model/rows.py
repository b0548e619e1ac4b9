"""Many impacts of one scene, some of whose numbers differ from row to row: the core's problems, one curve each."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import STANDARD_GRAVITY, Body, Plate
from film_model.core import native
from film_model.curve import Curve, curve_of
from film_model.edges import edged, wide
from film_model.effects import FIRST_ORDER_LOSS, change, gravity_change, law_values, march, zener
from film_model.elementwise import root
from film_model.errors import SimulationError
from film_model.laws import LAWS, AbstractLaw
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.yielding import yield_velocity
from film_model.limits import reflection_change
from film_model.problem import Array, Problem, contact_limit, problem_of
from film_model.scales import Scales
from film_model.scene import Scene

Index = NDArray[np.intp]


@dataclass(frozen=True)
class Rows:
    """Impacts that share a curve. The fields are those of :class:`~film_model.problem.Problem`, one value a row.

    index: which rows they are. start: the contacts as the core starts them (native.START_DTYPE). zener:
    λ = K^{2/5} m^{3/5} V^{1/5}/Z, nan where there is no Hertz stiffness.
    """

    index: Index
    law: str
    curve: Curve
    scales: Scales
    start: NDArray[Any]
    drift: Array
    share: Array
    mass: Array
    zener: Array


def scene_of_columns(scene: Scene, columns: Mapping[str, Array]) -> Scene:
    """The scene with arrays [SI] in place of some of its numbers, by path: its derived values are arrays too."""
    made = copy.copy(scene)
    for path, values in columns.items():
        *sections, name = path.split(".")
        owner: Any = made
        for section in sections:
            part = copy.copy(getattr(owner, section))
            object.__setattr__(owner, section, part)
            owner = part
        if path.startswith("contact.") and name not in owner.FIELDS:
            object.__setattr__(owner, "parameters", {**owner.parameters, name: values})
        else:
            object.__setattr__(owner, name, values)
    return made


VIBRATES = -101
"""Status of a row whose target vibrates between its edges."""


def rows_of(
    scene: Scene, columns: Mapping[str, Array], count: int, status: NDArray[np.int32] | None = None
) -> list[Rows]:
    """The problems of `count` impacts of a scene, some of whose numbers are columns (path → SI values, one a row).

    They are those of `problem_of` for the scene of each row, computed on whole arrays, which some rows are checked
    for; where arrays do not serve, row by row. Rows whose laws have the same dimensionless stages share a curve. Rows
    whose impactor does not approach, or that make no problem, are left out; if none makes one, the first one's error
    is raised. Left out, too, are rows whose target vibrates, of which no curve knows; status takes `VIBRATES` for them.
    """
    status = np.zeros(count, np.int32) if status is None else status
    moving = np.flatnonzero(_column(scene_of_columns(scene, columns).approach_velocity, count) > 0.0)
    try:
        plain = _plain(_part(scene, columns, moving), moving)
        found = list(_by_arrays(scene, columns, moving[plain]))
        right = all(_agrees(rows, scene, columns) for rows in found)
    except (TypeError, ValueError):
        found, right = [], False
    if not right:
        return _one_by_one(scene, columns, moving, status)
    left = np.setdiff1d(moving, np.concatenate([rows.index for rows in found])) if found else moving
    return found + (_one_by_one(scene, columns, left, status, bool(found)) if left.size else [])


SURE = 3.0
"""An effect is left in or out without a trial where its first-order size is so many times beyond the tolerance."""


def _plain(scene: Scene, index: Index) -> NDArray[np.bool_]:
    """Rows out of `index`, of which `scene` has the columns, whose effects formulas decide; others need trials."""
    effects, tolerance, count = scene.effects, scene.effect_tolerance, index.size
    plain = np.full(count, not edged(scene) or wide(scene))
    if effects.target_motion == "auto" and not isinstance(scene.target, Body):
        value = _motion(scene, count)
        off = np.where(np.isnan(value), tolerance, FIRST_ORDER_LOSS * value) / tolerance
        plain &= (off == 0.0) | (off < 1.0 / SURE) | (off > SURE)
    if effects.plasticity == "auto" and scene.contact.law == "auto":
        strength, modulus = scene.yield_strength, scene.effective_modulus
        if strength is not None and modulus is not None:
            limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
            ratio = _column(scene.approach_velocity / limit, count)
            plain &= (ratio < 0.9) | ((ratio > 2.0) & (tolerance <= 0.02))
    return plain


def _motion(scene: Scene, count: int) -> Array:
    """Zener's λ of every row: 0 for a target that does not move, nan where there is no Hertz stiffness."""
    impedance = _column(scene.target_impedance, count)
    value = np.zeros(count)
    if np.isfinite(impedance).any():
        modulus = math.nan if scene.effective_modulus is None else scene.effective_modulus
        stiffness = _column(hertz_stiffness(modulus, scene.effective_radius), count)
        mass, speed = _column(scene.effective_mass, count), _column(scene.approach_velocity, count)
        value = stiffness**0.4 * mass**0.6 * speed**0.2 / impedance
    return value


def _by_arrays(scene: Scene, columns: Mapping[str, Array], moving: Index) -> Iterator[Rows]:
    for law, index in _laws(_part(scene, columns, moving), moving):
        part = _part(scene, columns, index)
        values = {} if isinstance(law, AbstractLaw) else law_values(part, law)
        speed = _column(part.approach_velocity, index.size)
        mass = _column(part.effective_mass, index.size)
        for curve, chosen in _curves(law, values, index.size):
            rows = _problem(part, law, _picked(values, chosen), curve, index, chosen, speed[chosen], mass[chosen])
            if rows.index.size:
                yield rows


_NUMBERS = ("drift", "share", "mass")


def _agrees(rows: Rows, scene: Scene, columns: Mapping[str, Array]) -> bool:
    """Whether the first, middle and last row are what `problem_of` makes of their scenes."""
    for place in {0, rows.index.size // 2, rows.index.size - 1}:
        problem = problem_of(_at_row(scene, columns, int(rows.index[place])))
        same = [(getattr(rows, name)[place], getattr(problem, name)) for name in _NUMBERS]
        same += [(getattr(rows.scales, name)[place], value) for name, value in vars(problem.scales).items()]
        same += [(rows.start[name][place], getattr(problem.start, name)) for name in native.START_DTYPE.names or ()]
        curve = problem.curve is rows.curve or bytes(problem.curve.native) == bytes(rows.curve.native)
        same_kind = problem.law.name == rows.law and not problem.vibrates
        if not (curve and same_kind and np.allclose(*zip(*same, strict=True), rtol=1e-12, atol=0.0)):
            return False
    return True


def _one_by_one(
    scene: Scene,
    columns: Mapping[str, Array],
    moving: Index,
    status: NDArray[np.int32],
    others: bool = False,
) -> list[Rows]:
    """As `_by_arrays`, from the scene of every row. others: rows that make no problem are not all there are."""
    groups: dict[tuple[str, int], list[tuple[int, Problem]]] = {}
    first: Exception | None = None
    for row in moving.tolist():
        try:
            problem = problem_of(_at_row(scene, columns, row))
        except (SimulationError, ValueError) as error:
            first = first or error
            continue
        if problem.vibrates:
            status[row] = VIBRATES
            continue
        groups.setdefault((problem.law.name, id(problem.curve)), []).append((row, problem))
    if not groups and not others and first is not None and not (status[moving] == VIBRATES).any():
        raise first
    return [_gathered(members) for members in groups.values()]


def _gathered(members: list[tuple[int, Problem]]) -> Rows:
    index, problems = np.array([row for row, _ in members]), [problem for _, problem in members]
    numbers = {name: np.array([getattr(problem, name) for problem in problems]) for name in _NUMBERS}
    scales = [np.array([getattr(p.scales, scale.name) for p in problems]) for scale in fields(Scales)]
    motion = [zener(p.scene, p.scene.target_impedance) if p.gamma > 0.0 else 0.0 for p in problems]
    lambdas = np.array([np.nan if value is None else value for value in motion])
    start = np.concatenate([np.frombuffer(bytes(problem.start), native.START_DTYPE) for problem in problems])
    made = Scales(*cast("Any", scales))
    return Rows(index, problems[0].law.name, problems[0].curve, made, start, **numbers, zener=lambdas)


def _at_row(scene: Scene, columns: Mapping[str, Array], row: int) -> Scene:
    return scene_of_columns(scene, {path: cast("Any", float(values[row])) for path, values in columns.items()})


def _part(scene: Scene, columns: Mapping[str, Array], index: Index) -> Scene:
    return scene_of_columns(scene, {path: values[index] for path, values in columns.items()})


def _laws(scene: Scene, index: Index) -> Iterator[tuple[AbstractLaw | type[AbstractLaw], Index]]:
    """Laws and their rows out of `index`, of which `scene` has the columns: `effects.choose` for arrays."""
    law, wanted = scene.contact.law, scene.effects.plasticity
    if index.size == 0:
        return
    if law != "auto":
        yield (law if isinstance(law, AbstractLaw) else LAWS[law]), index
        return
    strength, modulus = scene.yield_strength, scene.effective_modulus
    if wanted is True and strength is None:
        raise SimulationError("effects.plasticity is true, but neither material has a yield_strength")
    if wanted is False or strength is None or modulus is None:
        yield LAWS["hertz"], index
        return
    threshold = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
    elastic = _column(scene.approach_velocity <= threshold, index.size) & (wanted is not True)
    for name, mask in (("hertz", elastic), ("big-alabo", ~elastic)):
        if mask.any():
            yield LAWS[name], index[mask]


def _curves(
    law: AbstractLaw | type[AbstractLaw], values: Mapping[str, Any], count: int
) -> Iterator[tuple[Curve, Index]]:
    """Curves and their rows. Where the stages do not depend on what varies, which most laws' do not, there is one."""
    everything = np.arange(count)
    if isinstance(law, AbstractLaw):
        yield curve_of(law), everything
        return
    varying = {name: np.asarray(v) for name, v in values.items() if isinstance(v, np.ndarray)}
    if not varying or _stages_are_blind_to(law, values, varying):
        yield curve_of(_made(law, values, 0)), everything
        return
    table = np.stack(list(varying.values()), axis=-1)
    _, first, group = np.unique(table, axis=0, return_index=True, return_inverse=True)
    curves: dict[int, tuple[Curve, list[int]]] = {}
    for number, row in enumerate(first.tolist()):
        curve = curve_of(_made(law, values, row))
        curves.setdefault(id(curve), (curve, []))[1].append(number)
    for curve, numbers in curves.values():
        yield curve, np.flatnonzero(np.isin(group.ravel(), numbers))


class _Seen(Exception):
    """A law's stages have asked for a value that varies."""


def _stages_are_blind_to(law: type[AbstractLaw], values: Mapping[str, Any], varying: Mapping[str, Any]) -> bool:
    """Whether stages() never reads these fields, and so gives the same stages whatever they are."""

    def look(_: AbstractLaw) -> Any:
        raise _Seen

    metaclass: Any = type(law)  # that of abstract classes
    blind = metaclass(law.__name__, (law,), {name: property(look) for name in varying})
    made = object.__new__(blind)
    for name, value in values.items():
        if name not in varying:
            object.__setattr__(made, name, value)
    try:
        made.stages()
    except _Seen:
        return False
    return True


def _problem(
    scene: Scene,
    law: AbstractLaw | type[AbstractLaw],
    values: Mapping[str, Any],
    curve: Curve,
    index: Index,
    chosen: Index,
    speed: Array,
    mass: Array,
) -> Rows:
    """As `problem_of`, for the rows `chosen` of a scene of columns."""
    count = chosen.size
    energy = 0.5 * mass * speed**2
    scales = _scales(law, values, energy, mass)
    approach = speed / scales.velocity
    drift, share = np.zeros(count), np.ones(count)
    if isinstance(scene.target, Body):
        share = mass / _column(scene.mass, index.size)[chosen]
        drift = _column(scene.impactor.speed, index.size)[chosen] - share * speed
    still = scene.effects.target_motion is False
    impedance = _column(math.inf if still else scene.target_impedance, index.size)[chosen]
    value = np.where(np.isfinite(impedance), _motion(scene, index.size)[chosen], 0.0)

    def one(row: int) -> Problem:
        """One of the impacts without its weight."""
        own = Scales(*(float(getattr(scales, scale.name)[row]) for scale in fields(Scales)))
        gamma = 0.0 if math.isinf(impedance[row]) else own.force / (float(impedance[row]) * own.velocity)
        numbers = float(approach[row]), float(drift[row]), float(share[row]), float(mass[row])
        return Problem(_made(law, values, row), curve, own, gamma, 0.0, *numbers, scene)

    gamma = scales.force / (impedance * scales.velocity)
    load = mass * STANDARD_GRAVITY * _heavy(scene, curve, scales, approach, gamma, mass, one)
    kept = slice(None)
    if edged(scene) and scene.effects.boundary_reflections == "auto":
        assert isinstance(scene.target, Plate)
        returns = _column(scene.target.return_time, index.size)[chosen]
        kept = _edges_hardly_matter(scene, curve, scales, approach, gamma, returns)
    if scene.effects.target_motion == "auto":
        impedance = np.where(FIRST_ORDER_LOSS * value < scene.effect_tolerance, math.inf, impedance)
    if load.any():
        weight_energy = load * 1e-3 * _column(scene.effective_radius, index.size)[chosen]
        scales = _scales(law, values, np.maximum(energy, weight_energy), mass)
        approach = speed / scales.velocity
    start: Any = np.zeros(count, native.START_DTYPE)
    start["nu"], start["gamma"] = approach, scales.force / (impedance * scales.velocity)
    start["load"], start["stop_velocity"] = load / scales.force, -drift / (share * scales.velocity)
    start["time_limit"] = np.where(load > 0.0, contact_limit(approach, start["gamma"]), math.inf)
    whole = Rows(index[chosen], law.name, curve, scales, start, drift, share, mass, value)
    return whole if isinstance(kept, slice) else _some(whole, kept)


def _some(rows: Rows, kept: NDArray[np.bool_]) -> Rows:
    """Some of the rows."""
    numbers = {name: getattr(rows, name)[kept] for name in ("index", "start", "zener", *_NUMBERS)}
    scales = Scales(*cast("Any", (getattr(rows.scales, scale.name)[kept] for scale in fields(Scales))))
    return replace(rows, scales=scales, **numbers)


def _edges_hardly_matter(
    scene: Scene, curve: Curve, scales: Scales, approach: Array, gamma: Array, returns: Array
) -> NDArray[np.bool_]:
    """Impacts on a plate with edges that need no trial to be on an infinite one. returns: return times, s."""
    start: Any = np.zeros(approach.size, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = approach, gamma, math.inf
    status, seen = native.batch(curve.native, native.mesh(native.WORK_PRESERVING, 4, 8), start)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = reflection_change(approach, gamma, seen, returns / scales.time)
    return (status == native.EVENT) & (off < scene.effect_tolerance / SURE)


def _heavy(
    scene: Scene,
    curve: Curve,
    scales: Scales,
    approach: Array,
    gamma: Array,
    mass: Array,
    one: Callable[[int], Problem],
) -> NDArray[np.bool_]:
    """Which impacts are simulated with their weight: the rule of `effects`, for each.

    One coarse batch without weight tells most of them apart; the doubtful are tried with and without, one by one.
    """
    wanted, tolerance, count = scene.effects.gravity, scene.effect_tolerance, approach.size
    if isinstance(scene.target, Body) or wanted is False:
        return np.zeros(count, np.bool_)
    if wanted is True:
        return np.ones(count, np.bool_)
    start: Any = np.zeros(count, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = approach, gamma, math.inf
    weight = mass * STANDARD_GRAVITY / scales.force
    status, seen = native.batch(curve.native, native.mesh(native.WORK_PRESERVING, 4, 8), start)
    with np.errstate(divide="ignore", invalid="ignore"):
        push = gravity_change(weight, seen["maximum_force"], seen["maximum_indentation"], 0.5 * approach**2)
        gained = weight * seen["contact_duration"] / -seen["final_velocity"]  # over the rebound velocity
        light = np.where(gamma > 0.0, np.maximum(push, gained) <= 0.1 * tolerance, push <= 0.3 * tolerance)
    heavy = ~light | (status != native.EVENT)
    for row in np.flatnonzero(heavy):
        problem = one(int(row))
        size = change(march(replace(problem, load=float(weight[row]))), march(problem))
        heavy[row] = size is None or size > tolerance
    return heavy


def _scales(law: AbstractLaw | type[AbstractLaw], values: Mapping[str, Any], energy: Array, mass: Array) -> Scales:
    """Scales of every row: by the law's formulas on arrays, or row by row where they take only floats."""

    def scales(row: int) -> tuple[float, float]:
        return _made(law, values, row).scales(float(energy[row]))

    found = _on_arrays(law, values, energy, scales) or zip(*map(scales, range(energy.size)), strict=True)
    length, force = (np.asarray(column) for column in found)
    time = root(mass * length / force)
    speed: Any = length / time
    return Scales(cast("Any", length), cast("Any", force), time, speed)


def _on_arrays(
    law: AbstractLaw | type[AbstractLaw],
    values: Mapping[str, Any],
    energy: Array,
    scales: Callable[[int], tuple[float, float]],
) -> tuple[Array, Array] | None:
    """What the law makes of arrays, if it is what it makes of their first and last rows; else None."""
    try:
        own = _made(law, values, slice(None))
        length, force = (_column(value, energy.size) for value in own.scales(cast("Any", energy)))
    except (TypeError, ValueError):
        return None
    for row in (0, energy.size // 2, energy.size - 1):
        if not np.allclose((length[row], force[row]), scales(row), rtol=1e-13, atol=0.0):
            return None
    return length, force


def _made(law: AbstractLaw | type[AbstractLaw], values: Mapping[str, Any], rows: Any) -> AbstractLaw:
    """The law of one row, or with arrays in its fields that of several."""
    return law if isinstance(law, AbstractLaw) else law(**_picked(values, rows))


def _picked(values: Mapping[str, Any], rows: Any) -> dict[str, Any]:
    """The values at one row, as floats, or at several."""
    at = {name: value[rows] if isinstance(value, np.ndarray) else value for name, value in values.items()}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in at.items()}


def _column(value: Any, count: int) -> NDArray[Any]:
    return np.broadcast_to(np.asarray(value), (count,))
