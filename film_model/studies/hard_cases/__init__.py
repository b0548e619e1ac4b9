"""A catalogue of hard cases, each with the reason why it is hard, and a report on how they are solved.

An impact is marched in one call, in irregular steps, in a batch and on the paper's chords. It must end as documented,
satisfy its balances, and agree with a reference that does not use the core: extended precision where the law allows
it, else quadrature or a tight integration. Histories under loads are checked against properties that must hold.
Impacts on targets that vibrate are compared with DOP853 on the same vibrations, and keep their energy.
"""

from __future__ import annotations

from film_model.studies.hard_cases.case import Finding, HardCase
from film_model.studies.hard_cases.impacts import coincidences, impedances, scales
from film_model.studies.hard_cases.loads import loads
from film_model.studies.hard_cases.reports import Report, page, report
from film_model.studies.hard_cases.single_impact import examine, problem_for
from film_model.studies.hard_cases.structures import structures


def all_cases() -> tuple[HardCase, ...]:
    """The catalogue."""
    return (*scales(), *impedances(), *coincidences(), *loads(), *structures())


__all__ = ["Finding", "HardCase", "Report", "all_cases", "examine", "page", "problem_for", "report"]
