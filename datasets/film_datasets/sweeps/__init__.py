"""Sweeps: many impacts of a scene, computed in blocks, written to memory, netCDF or Zarr, and resumed."""

# ruff: noqa: F401
# pyright: reportUnusedImport=false

from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.disk_space import sizes_text
from film_datasets.sweeps.progress import Interrupted, Progress, ProgressBar
from film_datasets.sweeps.runner import run_sweep, sweep
from film_datasets.sweeps.shards import finish_shards, run_shard
from film_datasets.sweeps.statistics import statistics, sweep_report
from film_datasets.sweeps.sweep_file import read_sweep, sweep_from_text
