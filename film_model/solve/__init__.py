"""Results: one impact (`film_model.solve.simulate.simulate`), a component in steps, many impacts; error estimates."""

from __future__ import annotations

from film_model.solve.batch import BatchResult, ManyResult, simulate_batch, simulate_many
from film_model.solve.component import ImpactComponent, Outputs, SavedState, StepResult
from film_model.solve.history import MOTION, Accuracy, Event, History, Samples

__all__ = [
    "MOTION",
    "Accuracy",
    "BatchResult",
    "Event",
    "History",
    "ImpactComponent",
    "ManyResult",
    "Outputs",
    "Samples",
    "SavedState",
    "StepResult",
    "simulate_batch",
    "simulate_many",
]
