"""TOML that any user may have written: whatever is wrong with it is one kind of error."""

from __future__ import annotations

import tomllib
from typing import Any


def parse_toml(text: str) -> dict[str, Any]:
    """The content of a TOML text, as `tomllib.loads` gives it.

    Raises:
        tomllib.TOMLDecodeError: it is no TOML, is nested too deep, or has an integer of more digits than Python reads.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("lists or tables nested too deep") from None
    except ValueError:
        raise tomllib.TOMLDecodeError("an integer of thousands of digits") from None
