"""The command line: options, calls of the API, printed results."""

import os

# The search runs in threads of its own, on matrices so small that those of OpenBLAS would only wait for work, busily.
# It is told before NumPy loads it; what the user has set stays.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
