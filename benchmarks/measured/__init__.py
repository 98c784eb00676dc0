"""Diagnoses of measured rigs, and a page on each: `python -m benchmarks.measured FOLDER`."""
