"""The README's Python runs as it stands there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from tests.acceptance.short import write_short_case

pytestmark = pytest.mark.slow

README = Path(__file__).resolve().parents[2] / "README.md"


def test_the_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the example on a case of the name that it uses, and find tables and files where it says."""
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    case = write_short_case(tmp_path / "my_rig")
    (tmp_path / "swing_07.csv").write_bytes((case / "rec_02.csv").read_bytes())
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code, names)
    assert isinstance(names["comparison"].scores, pd.DataFrame)
    assert list(names["prediction"].columns) == ["time_s", "ball_position_m", "low_m", "high_m"]
    assert (tmp_path / "reports" / "my_rig" / "diagnosis.json").is_file()
    assert (tmp_path / "reports" / "my_rig" / "diagnosis.html").is_file()
