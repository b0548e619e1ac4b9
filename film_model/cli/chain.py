"""film-model run of a file with sections [[bodies]]: a chain of bodies."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from film_model.cli.output import give_result

if TYPE_CHECKING:
    from film_model.scene.chain import Chain
    from film_model.solve.chain_motion import ChainMotion

MOST_ROWS = 8
"""Rows of a table without --verbose, half of them at its end."""

NOT_FOR_CHAINS = ("strobe", "segments", "linearisation", "derivatives")


def run_chain(chain: Chain, options: argparse.Namespace) -> int:
    from film_model.solve.chain_motion import simulate_chain_quietly

    for name in NOT_FOR_CHAINS:
        if getattr(options, name):
            raise ValueError(f"--{name} is not for a chain of bodies")
    if options.accuracy is not None:
        table = chain.to_table()
        chain = chain.from_table({**table, "solver": {**table["solver"], "accuracy": options.accuracy}})
    motion = simulate_chain_quietly(chain)
    return give_result(options, motion, lambda: _text(motion, options.verbose))


def _text(motion: ChainMotion, verbose: bool) -> str:
    from film_model.solve.chain_motion import BODIES, CONTACTS

    energy = motion.energy
    whole = max(energy.kinetic_before + energy.weight, energy.kinetic_after)
    laws = ", ".join(dict.fromkeys(motion.laws))
    lines = [motion.chain.title or "Chain", f"law {laws}; {motion.outcome}"]
    short = [name for name in CONTACTS if name != "contact_ends"]
    for what, names in (("body", BODIES), ("contact", CONTACTS if verbose else short)):
        dimensions = [(BODIES | CONTACTS)[name][0] for name in names]
        lines += ["", f"  {what:8}" + "".join(f"{_head(name):>18}" for name in names)]
        rows = motion.rows(names)
        numbers = motion.chain.link_names if names is not BODIES else [str(number + 1) for number in range(len(rows))]
        named = list(zip(numbers, rows, strict=True))
        for number, row in _shown(named, len(rows) if verbose else MOST_ROWS):
            cells = (_cell(value, kind, whole) for value, kind in zip(row.values(), dimensions, strict=True))
            lines.append(f"  {number:8}" + "".join(f"{cell:>18}" for cell in cells))
        if len(rows) > MOST_ROWS and not verbose:
            lines.insert(-MOST_ROWS // 2, f"  ... {len(rows) - MOST_ROWS} more")
    parts = {"before": energy.kinetic_before, "after": energy.kinetic_after, "absorbed": energy.absorbed}
    parts |= {"of weight": energy.weight} if motion.chain.gravity else {}
    lines += ["", "  energy  " + ", ".join(f"{name} {_cell(value, 'energy', whole)}" for name, value in parts.items())]
    within = f"balance of energy within {max(abs(energy.error) / whole, 1e-12):.0e}"
    lines.append(f"  {within}; estimated relative error ≤ {motion.estimated:.1e}")
    return "\n".join(lines)


def _cell(value: float | None, dimension: str, energy: float) -> str:
    """A value with unit; energies that are rounding, compared with that of all bodies [J], as 0."""
    from film_model.base.units import format_si

    if value is None:
        return "-"
    return format_si(0.0 if dimension == "energy" and abs(value) < 1e-11 * energy else value, dimension, 5)


def _head(name: str) -> str:
    return {"time_of_largest_force": "at", "energy_absorbed": "absorbed", "largest_indentation": "indentation"}.get(
        name, name.replace("contact_", "").replace("body_", "").replace("_velocity", "").replace("_", " ")
    )


def _shown(rows: list[tuple[str, dict[str, Any]]], most: int) -> list[tuple[str, dict[str, Any]]]:
    """The rows without the middle ones of more than `most`."""
    return rows if len(rows) <= most else [*rows[: most // 2], *rows[len(rows) - most // 2 :]]
