"""Mutation testing: changes one operator or number of a module at a time, and lists the changes that no test notices.

    python -m tests.mutation analytic/step.py --sample 80

mutmut's operators make the mutants. They are run here, because its own runner leaves out decorated functions, that is
all compiled ones and all properties, and what stands outside of functions. As there, the libraries are loaded once and
every mutant runs in a fork; here it is handed to the child's import. Which modules are mutated, by which operators, and
which tests run is in `pyproject.toml`, table `tool.mutation`.

Before any mutant, the tests run on the module as it is. Those that fail, or take longer than the configuration allows,
are left out; the others run in the order of their cost until the first fails. With numba switched off ("jit = false")
compiled functions are Python, and a mutant of them takes effect without being compiled.
"""

from __future__ import annotations

import argparse
import difflib
import hashlib
import importlib
import json
import os
import random
import resource
import signal
import sys
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import CodeType
from typing import Any

import libcst as cst
import pytest
from hypothesis import HealthCheck, settings
from libcst.metadata import MetadataWrapper, PositionProvider
from mutmut.mutation.mutators import mutation_operators

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "build" / "mutants"
OWN = ("analytic", "harness", "mjcf", "urdf", "tests")
MEMORY = 8 * 2**30  # a mutant may ask for any array [byte]
SLACK = 20.0  # for imports and collection [s]
# What costs time and is not needed: the fixtures of whole cases, and the plugin under test elsewhere.
OPTIONS = ("-p", "no:cacheprovider", "-p", "no:harness", "--noconftest")
settings.register_profile("mutants", derandomize=True, database=None, deadline=None, suppress_health_check=HealthCheck)


@dataclass(frozen=True)
class Target:
    """Modules under the same tests.

    Attributes:
        modules: paths from the repository's root.
        tests: files and folders of tests.
        jit: whether compiled functions stay compiled.
    """

    modules: tuple[str, ...]
    tests: tuple[str, ...]
    jit: bool


@dataclass(frozen=True, eq=False)
class Mutant:
    """One change of a module: its number among all, its line, and the node that takes another's place."""

    number: int
    line: int
    module: cst.Module
    node: cst.CSTNode
    changed: cst.CSTNode

    def source(self) -> str:
        """The module with this change."""
        return self.module.deep_replace(self.node, self.changed).code

    def described(self, killed: bool) -> dict[str, Any]:
        """What is kept of it: the lines that differ, before and after, and whether a test noticed."""
        lines = [self.module.code.splitlines(), self.source().splitlines()]
        both = list(difflib.unified_diff(*lines, lineterm="", n=0))[3:]
        before, after = (" ⏎ ".join(line[1:].strip() for line in both if line[0] == sign) for sign in "-+")
        return {"number": self.number, "line": self.line, "before": before, "after": after, "killed": killed}


class Places(cst.CSTVisitor):
    """Finds what mutmut's operators can change, except in annotations and decorators."""

    METADATA_DEPENDENCIES = (PositionProvider,)

    def __init__(self, module: cst.Module, operators: Sequence[tuple[type, Callable[[Any], Iterable[cst.CSTNode]]]]):
        super().__init__()
        self.module = module
        self.operators = operators
        self.found: list[Mutant] = []

    def on_visit(self, node: cst.CSTNode) -> bool:
        """Note the changes of one node."""
        if isinstance(node, cst.Annotation | cst.Decorator):
            return False
        for kind, operator in self.operators:
            for changed in operator(node) if isinstance(node, kind) else ():
                line = self.get_metadata(PositionProvider, node).start.line
                self.found.append(Mutant(len(self.found), line, self.module, node, changed))
        return True


class Finder(MetaPathFinder):
    """Imports one module from a string instead of its file."""

    def __init__(self, file: Path, source: str) -> None:
        self.file, self.source = file, source
        self.name = ".".join(file.relative_to(ROOT).with_suffix("").parts)

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        """The module's specification, or None for all others."""
        if fullname != self.name:
            return None
        return spec_from_file_location(fullname, self.file, loader=Loader(fullname, str(self.file), self.source))


class Loader(SourceFileLoader):
    """Compiles a string."""

    def __init__(self, fullname: str, path: str, source: str) -> None:
        super().__init__(fullname, path)
        self.source = source

    def get_code(self, fullname: str) -> CodeType:
        """The string's code; nothing is cached."""
        return compile(self.source, self.path, "exec", dont_inherit=True)


class Timing:
    """Takes the processor time of each test, and breaks off those that take too long."""

    def __init__(self, longest: float) -> None:
        self.longest = longest
        self.cost: dict[str, float] = {}
        self.failed: set[str] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Time one test with its fixtures."""
        begin = time.process_time()
        try:
            return (yield)
        finally:
            self.cost[item.nodeid] = time.process_time() - begin

    @pytest.hookimpl(wrapper=True)
    def pytest_pyfunc_call(self, pyfuncitem: pytest.Function) -> Iterator[None]:
        """Break off a test, and nothing of pytest's own around it."""

        def stop(*_: object) -> None:
            raise pytest.skip.Exception("too long")  # which Hypothesis lets pass

        signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, self.longest)
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note what did not pass."""
        if not report.passed:
            self.failed.add(report.nodeid)


class Cheapest:
    """Runs the tests of known cost, in its order."""

    def __init__(self, cost: dict[str, float]) -> None:
        self.cost = cost

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep and sort."""
        items[:] = sorted((item for item in items if item.nodeid in self.cost), key=lambda item: self.cost[item.nodeid])


def forked(tests: Sequence[str], plugin: object, seconds: float, finder: Finder | None, report: Path | None) -> bool:
    """Whether the tests pass in a child of its own, within so much processor time."""
    child = os.fork()
    if not child:
        status = 1
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, 1)
            os.dup2(nowhere, 2)
            if finder is not None:
                sys.meta_path.insert(0, finder)
                importlib.import_module(finder.name)  # now: pytest's own finder would take it from its file
            settings.load_profile("mutants")
            stop = [] if finder is None else ["-x"]
            status = int(pytest.main(["-q", *stop, *OPTIONS, *tests], plugins=[plugin]))
            if report is not None and isinstance(plugin, Timing) and status in (0, 1):  # it went to its end
                cost = {name: cost for name, cost in plugin.cost.items() if name not in plugin.failed}
                loaded = [name for name in sys.modules if name.partition(".")[0] not in OWN]
                report.write_text(json.dumps({"cost": cost, "dropped": sorted(plugin.failed), "loaded": loaded}))
        finally:
            os._exit(status)
    return os.waitpid(child, 0)[1] == 0


def mutants_of(source: str, without: Sequence[str]) -> list[Mutant]:
    """All mutants of a source in the order of its lines, but those that these operators make."""
    tree = MetadataWrapper(cst.parse_module(source))
    places = Places(tree.module, [pair for pair in mutation_operators if pair[1].__name__ not in without])
    tree.visit(places)
    return places.found


def baseline(target: Target, longest: float) -> dict[str, Any]:
    """Cost of each test that passes in time on the sources as they are, and the libraries that are loaded by then."""
    places = [ROOT / name for name in ("analytic", "harness", *target.tests)]
    sources = sorted(file for place in places for file in ([place] if place.is_file() else place.rglob("*.py")))
    key = hashlib.sha256(repr((target.tests, target.jit, longest)).encode())
    for source in sources:
        key.update(source.read_bytes())
    report = RESULTS / f"baseline-{key.hexdigest()[:16]}.json"
    if not report.exists():
        forked(target.tests, Timing(longest), 3600.0, None, report)
    if not report.exists():
        raise SystemExit(f"the tests {' '.join(target.tests)} do not run to their end")
    return dict(json.loads(report.read_text()))


def run_module(module: str, target: Target, table: dict[str, Any], options: argparse.Namespace) -> None:
    """Run mutants of one module, print those that survive, and keep the results."""
    os.environ["NUMBA_DISABLE_JIT"] = str(int(not target.jit))
    known = baseline(target, table["longest_test_s"])
    for name in known["loaded"]:
        try:
            importlib.import_module(name)
        except Exception:
            continue
    file = ROOT / module
    source = file.read_text()
    plugin, seconds = Cheapest(known["cost"]), 3.0 * sum(known["cost"].values()) + SLACK
    if not known["cost"] or not forked(target.tests, plugin, seconds, Finder(file, source), None):
        raise SystemExit(f"{module}: the tests do not pass on the module as it is")
    mutants = mutants_of(source, table["without_operators"])
    count = len(mutants)
    kept = RESULTS / f"{module.replace('/', '.')}.json"
    before: dict[int, dict[str, Any]] = {}
    if options.survivors:
        before = {one["number"]: one for one in json.loads(kept.read_text())["mutants"]}
        mutants = [one for one in mutants if one.number in before and not before[one.number]["killed"]]
    elif options.sample and options.sample < count:
        mutants = random.Random(f"{options.seed} {module}").sample(mutants, options.sample)
    done = {}
    for one in sorted(mutants, key=lambda one: one.number):
        killed = not forked(target.tests, plugin, seconds, Finder(file, one.source()), None)
        done[one.number] = one.described(killed)
        if not killed:
            print(f"  {module}:{one.line}: {done[one.number]['before']}  →  {done[one.number]['after']}", flush=True)
    results = list((before | done).values())
    kept.write_text(json.dumps({"module": module, "of": count, "mutants": results}, indent=1, ensure_ascii=False))
    print(row(module, count, len(results), sum(one["killed"] for one in results), len(known["cost"])), flush=True)


def row(module: str, count: int, run: int, killed: int, tests: int) -> str:
    """One row of the table; a sample with its 95 % interval after Wilson."""
    from scipy.stats import binomtest

    share = f"{100 * killed / run:.0f} %"
    if run < count:
        interval = binomtest(killed, run).proportion_ci(method="wilson")
        share += f" ({100 * interval.low:.0f}–{100 * interval.high:.0f} %)"
    return f"| `{module}` | {count} | {run} | {killed} | {run - killed} | {share} | {tests} |"


def main() -> None:
    """Read the command line, and run every module in a process of its own."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("modules", nargs="*", help="files to mutate, all those of the configuration by default")
    parser.add_argument("--sample", type=int, help="mutants of each module, drawn at random; all by default")
    parser.add_argument("--seed", type=int, default=0, help="of the drawing")
    parser.add_argument("--survivors", action="store_true", help="run those again that survived the last time")
    options = parser.parse_args()
    table = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mutation"]
    targets = [Target(tuple(one["modules"]), tuple(one["tests"]), one["jit"]) for one in table["targets"]]
    target_of = {module: target for target in targets for module in target.modules}
    unknown = set(options.modules) - set(target_of)
    if unknown:
        parser.error(f"pyproject.toml has no tests for {', '.join(sorted(unknown))}")
    RESULTS.mkdir(parents=True, exist_ok=True)
    os.chdir(ROOT)
    os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    print("| module | mutants | run | killed | survived | share | tests |\n|---|---|---|---|---|---|---|", flush=True)
    failed = False
    for module in options.modules or target_of:
        child = os.fork()
        if not child:
            status = 1
            try:
                run_module(module, target_of[module], table, options)
                status = 0
            except SystemExit as stop:
                print(stop, file=sys.stderr, flush=True)
            except BaseException:
                sys.excepthook(*sys.exc_info())
            finally:
                os._exit(status)
        failed |= os.waitpid(child, 0)[1] != 0
    raise SystemExit(failed)


if __name__ == "__main__":
    main()
