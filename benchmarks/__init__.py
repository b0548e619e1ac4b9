"""Computing times of FILM and of other methods at equal accuracy. Run `python -m benchmarks.speed`."""

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before numpy is imported: every method uses one core
