"""Tolerance checks of a case as pytest tests: `pytest --case DIR --set mujoco.friction=0.3`.

Every pytest run in the environment imports this module; heavy imports are therefore deferred until a case is named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from harness.errors import InputError

if TYPE_CHECKING:
    from harness.tolerances import Checked
    from harness.tolerances.inspection import Inspection

BUNDLED = "bundled"
_INSPECTION = pytest.StashKey["Inspection"]()


_OPTIONS: dict[str, dict[str, Any]] = {
    "case": {
        "metavar": "DIR",
        "help": f"check the limits of this case: a folder, its rig.toml or a CSV recording; `{BUNDLED}` for the "
        "bundled one. Unless test files are named too, nothing else is collected.",
    },
    "recording": {"metavar": "NAME", "help": "recording of the case to check"},
    "set": {
        "action": "append",
        "default": [],
        "metavar": "ENGINE.NAME=VALUE",
        "help": "set a contact parameter, as in mujoco.friction=0.3; repeatable",
    },
    "parameters": {"type": Path, "metavar": "FILE", "help": "contact parameters, one TOML table per engine"},
    "engine": {
        "action": "append",
        "default": [],
        "metavar": "NAME",
        "help": "check the limits on this engine and not on others; repeatable (default: every engine with a limit)",
    },
    "tolerances": {
        "type": Path,
        "metavar": "FILE",
        "help": "limits (default: tolerances.toml of the case, else the package's)",
    },
}


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, named as in `harness run`."""
    group = parser.getgroup("harness", "tolerance checks of a ball-and-beam case")
    for name, details in _OPTIONS.items():
        group.addoption(f"--{name}", dest=f"harness_{name}", **details)


def pytest_configure(config: pytest.Config) -> None:
    """With a case and no test files named, collect the case alone."""
    if _wanted(config, "case") is None:
        given = [name for name in _OPTIONS if _wanted(config, name)]
        if given:
            raise pytest.UsageError(f"--{given[0]} needs --case DIR")
    elif config.args_source is not pytest.Config.ArgsSource.ARGS:
        config.args = []


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Read and validate the case and its limits before anything runs."""
    config = session.config
    if _wanted(config, "case") is None:
        return
    from harness.tolerances.inspection import inspect

    try:
        config.stash[_INSPECTION] = inspect(
            _case_path(config),
            recording=_wanted(config, "recording"),
            engines=_wanted(config, "engine"),
            assignments=_wanted(config, "set"),
            parameters=_wanted(config, "parameters"),
            tolerances=_wanted(config, "tolerances"),
        )
    except InputError as error:
        raise pytest.UsageError(str(error)) from error


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Report header: recording, limits and changed parameters."""
    inspection = config.stash.get(_INSPECTION, None)
    return _header(inspection) if inspection else []


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(session: pytest.Session, config: pytest.Config, items: list[pytest.Item]) -> None:
    """Add one test per limit, before `-k` and similar options select."""
    inspection = config.stash.get(_INSPECTION, None)
    if inspection is None:
        return
    case = _case_path(config)
    name = _case_name(config, case)
    collector = CaseCollector.from_parent(session, name=name, path=case, nodeid=name)
    items.extend(session.genitems(collector))
    left_out = [LimitItem.from_parent(collector, name=str(limit)) for limit in inspection.left_out]
    if left_out:
        config.hook.pytest_deselected(items=left_out)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """List every limit that was checked, kept or broken, with value and margin."""
    inspection = config.stash.get(_INSPECTION, None)
    if inspection is None or config.option.collectonly:
        return
    from harness.tolerances import render_table

    found = {one.name: one for one in _checked(terminalreporter)}
    names = [str(limit) for limit in inspection.tolerances.limits]
    terminalreporter.ensure_newline()
    terminalreporter.section("tolerances")
    for line in _header(inspection):
        terminalreporter.write_line(line)
    if found:
        terminalreporter.write_line(render_table([found[name] for name in names if name in found]))
    limits = (*inspection.tolerances.limits, *inspection.left_out)
    missing = Counter(limit.source for limit in limits if str(limit) not in found)
    if missing:
        text = ", ".join(f"{count} on {source}" for source, count in missing.items())
        terminalreporter.write_line(f"{missing.total()} of {len(limits)} limits not checked: {text}")


class CaseCollector(pytest.Collector):
    """The case; its children are its limits."""

    def collect(self) -> Iterator[LimitItem]:
        """One test per limit, in the order of the file."""
        for limit in self.config.stash[_INSPECTION].tolerances.limits:
            yield LimitItem.from_parent(self, name=str(limit))


class BrokenLimitError(Exception):
    """A limit is broken."""

    def __init__(self, checked: Checked) -> None:
        super().__init__(checked.text())
        self.checked = checked


class LimitItem(pytest.Item):
    """The test of one limit; the first one runs models and engines."""

    def runtest(self) -> None:
        """Checks the limit; the outcome is stored in the properties of the report, also for JUnit files.

        Raises:
            BrokenLimitError: the limit is broken.
        """
        checked = self.config.stash[_INSPECTION].checks[self.name]
        self.user_properties.extend(asdict(checked).items())
        if not checked.passed:
            raise BrokenLimitError(checked)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Value, limit, margin and changed parameters, instead of a traceback."""
        if not isinstance(excinfo.value, BrokenLimitError):
            return super().repr_failure(excinfo, style)
        tweaks = self.config.stash[_INSPECTION].tweaks
        return "\n".join([excinfo.value.checked.outcome(), *(f"set: {tweak}" for tweak in tweaks)])

    def reportinfo(self) -> tuple[Path, None, str]:
        """Location and name of the limit."""
        return self.config.stash[_INSPECTION].tolerances.path, None, self.name


def _wanted(config: pytest.Config, name: str) -> Any:
    return config.getoption(f"harness_{name}")


def _case_path(config: pytest.Config) -> Path:
    given = Path(_wanted(config, "case"))
    if str(given) != BUNDLED or given.exists():
        return given
    from harness.recording import case as cases

    return cases.BUNDLED


def _case_name(config: pytest.Config, case: Path) -> str:
    """Path relative to the root folder, as pytest prints files."""
    if case != Path(_wanted(config, "case")):
        return BUNDLED
    path = case.resolve()
    inside = path != config.rootpath and path.is_relative_to(config.rootpath)
    return path.relative_to(config.rootpath).as_posix() if inside else path.name


def _header(inspection: Inspection) -> list[str]:
    tolerances, recording = inspection.tolerances, inspection.setting.recording
    return [
        f"recording: {recording.path}",
        f"limits: {tolerances.path} ({tolerances.chosen})",
        *(f"set: {tweak}" for tweak in inspection.tweaks),
    ]


def _checked(reporter: pytest.TerminalReporter) -> Iterator[Checked]:
    """Outcomes from the test reports, which come from other processes with pytest-xdist."""
    from harness.tolerances import Checked

    names = {field.name for field in fields(Checked)}
    for outcome in ("passed", "failed"):
        for report in reporter.stats.get(outcome, ()):
            properties = dict(report.user_properties)
            if names <= properties.keys():
                yield Checked(**{name: properties[name] for name in names})
