"""The command line: one file per group of commands, each with its options and what it prints.

`film_model.cli.main.main` is the entry point. A command imports film_datasets, fmu_wrapper, the studies, the plots and
`base.files` when it runs: xarray alone takes longer to import (0.7 s of CPU) than `film-model run` takes as a whole.
Modules that `import film_model` loads anyway are imported at the top.
"""
