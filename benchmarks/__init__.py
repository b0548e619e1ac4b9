"""What an impact costs in time: FILM and its rivals at equal accuracy. Run `python -m benchmarks.speed`."""
