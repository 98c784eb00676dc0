"""How far a diagnosis can be trusted: blind trials with a known truth, and the tables made of them.

`python -m benchmarks.calibration` (`make calibrate`) runs what is missing and writes `docs/calibration.md`.
"""
