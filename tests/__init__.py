"""Tests; workers side by side have the processors for themselves, as the command line's processes have."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is loaded: two busy workers would wait for each other
