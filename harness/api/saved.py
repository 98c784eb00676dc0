"""A diagnosis as its diagnosis.json has it: verdict, effects, tables, predictions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.api.effects import Given, beside_catalogue
from harness.api.writing import settle
from harness.errors import InputError
from harness.formatting import number
from harness.identify.record import (
    AT_BOUND,
    FILE,
    DiagnosisRecord,
    EffectRecord,
    FailureRecord,
    RmsRecord,
    UnlistedRecord,
    read_record,
    unusable,
)
from harness.recording import DataFinding, Recording, Sensors, load_recording
from harness.recording.findings import warnings_of
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from analytic.motion import FloatArray


class LoadedDiagnosis(Summarised):
    """A diagnosis that was read from diagnosis.json.

    Attributes:
        record: all of diagnosis.json.
        origin: the file, or the case that was diagnosed.
    """

    def __init__(self, record: DiagnosisRecord, origin: Path, effects: Sequence[Given] = ()) -> None:
        """Take a record, where it comes from, and effects of one's own that it may name."""
        self.record, self.origin, self._own = record, origin, tuple(effects)

    @property
    def own_effects(self) -> tuple[Given, ...]:
        """Effects of one's own that the model may name."""
        return self._own

    @property
    def verdict(self) -> str:
        """`none`, `effect`, `unlisted` or `not_identifiable`."""
        return self.record.verdict

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return self.record.sentence

    @property
    def effects(self) -> dict[str, EffectRecord]:
        """The effects found, by name: `effects["level_error"]["angle"]` has `value`, `interval` (95 %) and `unit`."""
        return {one.name: one for one in self.record.effects}

    @property
    def unlisted(self) -> UnlistedRecord | None:
        """The law that no catalogue lists, if there is one."""
        return self.record.unlisted

    @property
    def failures(self) -> tuple[FailureRecord, ...]:
        """Engines, candidates, report sections and other parts that failed, without which it was made."""
        return self.record.failures

    @property
    def findings(self) -> tuple[DataFinding, ...]:
        """Warnings and notes on the input."""
        return tuple(one.finding() for one in self.record.findings)

    @property
    def sensors(self) -> Sensors:
        """What is known of the sensors that recorded."""
        return Sensors(**self.record.model.sensors.model_dump())

    @property
    def ledger(self) -> pd.DataFrame:
        """Every attempt of the search, one a row, in order."""
        import pandas as pd

        return pd.DataFrame([one.model_dump() for one in self.record.ledger])

    @property
    def errors(self) -> pd.DataFrame:
        """RMS prediction errors without and with what was found: `data, source, horizon, before_m, after_m`."""
        import pandas as pd

        return pd.DataFrame(self._errors(), columns=["data", "source", "horizon", "before_m", "after_m"])

    def _errors(self) -> list[tuple[str, str, str, float | None, float | None]]:
        told = self.record.errors
        runs: list[tuple[str, str, RmsRecord, RmsRecord]] = []
        for data, cam in (("heldout", told.heldout), ("identify", told.identify)):
            runs.append((data, "cam", cam.before, cam.after))
            for name, engine in told.engines.items():
                one = engine.heldout if data == "heldout" else engine
                runs += [] if one is None else [(data, name, one.before, one.after)]
        for also, each in told.also.items():
            runs.append((f"also {also}", "cam", each.before, each.after))
            runs += [(f"also {also}", name, one.before, one.after) for name, one in each.engines.items()]
        return [
            (data, source, horizon, before.rms_m.get(horizon), after.rms_m.get(horizon))
            for data, source, before, after in runs
            for horizon in dict.fromkeys((*before.rms_m, *after.rms_m))
        ]

    @one_blas_thread()
    def predict(self, recording: Recording | str | Path) -> pd.DataFrame:
        """Predict ball positions from the angle alone, with the identified model.

        The initial state comes from the positions that are known; leave those of the first second or so in it.
        Where the likelihood did not explain the recordings of the diagnosis, positions are kept within those recorded
        (`record.model.travel_m`); their band is that of a free ball.

        Args:
            recording: a CSV file, or one that was read.

        Returns:
            `time_s, ball_position_m` and the 95 % band `low_m, high_m`.

        Raises:
            InputError: the recording cannot be used, the model names an effect that the catalogue does not have or has
                numbers that no fit could have given, or positions come out that are not finite.
        """
        import pandas as pd

        return pd.DataFrame(self._predicted(recording))

    def _predicted(self, recording: Recording | str | Path) -> dict[str, FloatArray]:
        """The columns of `predict`."""
        sensors = self.sensors
        read = load_recording(recording, sensors=sensors) if isinstance(recording, str | Path) else recording
        import numpy as np

        try:
            with beside_catalogue(self._own):
                table = self._forecast(read, sensors)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise InputError(
                f"{self.origin}: its model does not predict {read.path} ({error}); diagnose anew"
            ) from error
        if not all(np.isfinite(column).all() for column in table.values()):
            raise InputError(
                f"{self.origin}: its model predicts positions of {read.path} that are not finite; diagnose anew"
            )
        return table

    def _forecast(self, read: Recording, sensors: Sensors) -> dict[str, FloatArray]:
        """The columns of a prediction; the effects are beside the catalogue."""
        from harness.identify.estimate.forecast import forecast
        from harness.identify.model_file import observed_for, prepared_for, read_forecasting, with_noise_of

        observed = observed_for(self.record.model, read, sensors)
        model = with_noise_of(self.record.model, observed.used)
        record = prepared_for(model, observed)
        problem, found = read_forecasting(model, record, str(self.origin))
        return forecast(problem, found, record, record.reading).table()

    def plot(self) -> Figure:
        """RMS errors of predicted positions, held out, without and with what was found."""
        from harness.report.diagnosis.kept_errors import drawn

        return drawn([one[1:] for one in self._errors() if one[0] == "heldout"])

    def summary(self) -> Summary:
        """The verdict in words, the effects, the held-out errors."""
        rows = [
            (f"`{one.name}`", f"`{key}`", number(each.value, 4), _interval(each.interval), each.unit, rivals)
            for one in self.record.effects
            for rivals in [", ".join(map(" + ".join, one.rivals)) or "nothing"]
            for key, each in one.parameters.items()
        ]
        columns = [*texts("effect", "parameter"), "value", "95 % interval", *texts("unit", "not to be told from")]
        tables = [Table("Effects", columns, rows)] if rows else []
        errors = [
            (source, horizon, *("–" if one is None else number(1e3 * one) for one in both))
            for data, source, horizon, *both in self._errors()
            if data == "heldout"
        ]
        heads = [*texts("predicted by", "over"), "before [mm]", "after [mm]"]
        tables.append(Table("RMS errors, held out", heads, errors))
        lines = [self.sentence]
        lines += [f"{one.where}: {one.text}" for one in warnings_of(self.findings)]
        lines += map(str, self.failures)
        if self.record.next_experiment is not None:
            lines.append(self.record.next_experiment.sentence.replace("_", " "))
        return Summary(f"Diagnosis of {self.origin}", lines, tables)


def _interval(ends: tuple[float | None, float | None]) -> str:
    return " … ".join("?" if one is None else number(one, 4) for one in ends)


@one_blas_thread()
def load_diagnosis(path: str | Path, *, effects: Sequence[Given] = ()) -> LoadedDiagnosis:
    """Read a diagnosis.json, to look at it or to predict with it.

    Args:
        path: of the file, or of the folder that it is in.
        effects: effects of your own that it was made with, as Python files or as `Effect` objects.

    Raises:
        InputError: it is no diagnosis.json that this version can use.
    """
    kept = as_written(path, effects=effects)
    with beside_catalogue(effects):
        _check_effects(kept.record, kept.origin)
    return kept


def as_written(path: str | Path, *, effects: Sequence[Given] = ()) -> LoadedDiagnosis:
    """As `load_diagnosis`, but for a replay, which tells itself what cannot be."""
    path = Path(path)
    file = path / FILE if path.is_dir() else path
    settle(file.parent)
    return LoadedDiagnosis(read_record(file), file, effects)


def _check_effects(record: DiagnosisRecord, file: Path) -> None:
    """Refuse effects of the catalogue with parameters that they do not have, or in another unit or out of bounds.

    Where the bounds depend on the recordings, only a prediction can tell.
    """
    from analytic.effects import CATALOGUE

    for at, one in enumerate(record.effects):
        if one.name not in CATALOGUE:
            continue
        known = {parameter.name: parameter for parameter in CATALOGUE[one.name].parameters}
        where = f"effects.{at}.parameters"
        if set(one.parameters) != set(known):
            raise unusable(file, where, f"{one.name} has {', '.join(known)}, not {', '.join(one.parameters)}")
        for name, given in one.parameters.items():
            parameter = known[name]
            if given.unit != parameter.unit:
                raise unusable(file, f"{where}.{name}.unit", f"it is {parameter.unit!r}, not {given.unit!r}")
            low, high = parameter.low, parameter.high
            slack = AT_BOUND * (high - low)
            if parameter.fitted is None and not low - slack <= given.value <= high + slack:
                text = f"{given.value:g} is not between {low:g} and {high:g} {parameter.unit}"
                raise unusable(file, f"{where}.{name}.value", text.removesuffix(" 1"))
