"""Files as instruments and programs write them, of one simulated recording; each by the format's own writer."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import scipy.io as sio

from analytic.motion import FloatArray
from tests.importing import made_matlab as mat
from tests.recording.simulated import simulated

CRANK, LEVER = 0.05, 0.4  # of the linkage of `scope_struct` [m]
ANGLE_VOLTS, POSITION_VOLTS, POSITION_OFFSET = 0.05, 0.125, -0.1  # rad/V, m/V, m
SCOPE_OPTIONS = ("--angle", "CH1:0.05 rad/V", "--position", "CH2:0.125 m/V-0.1")


def truth() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time [s], beam angle [rad], ball position [m]; simulated, 12 s at 100 Hz."""
    return simulated()


def volts() -> tuple[FloatArray, FloatArray]:
    """What two channels of an oscilloscope see of angle and position [V]."""
    _, angle, position = truth()
    return angle / ANGLE_VOLTS, (position - POSITION_OFFSET) / POSITION_VOLTS


def scope_struct(path: Path) -> Path:
    """What a Simulink Scope saves as "structure with time": servo angle in degrees, position without a unit."""
    time, angle, position = truth()
    crank = np.degrees(np.arcsin(np.sin(angle) * LEVER / CRANK))
    signals = np.zeros((1, 2), dtype=[("values", object), ("dimensions", object), ("label", object)])
    for at, (values, label) in enumerate(((crank, "theta (deg)"), (position, "x"))):
        signals[0, at] = (values[:, None], 1.0, label)
    sio.savemat(path, {"ScopeData": {"time": time[:, None], "signals": signals, "blockName": "model/Scope"}})
    return path


def vectors(path: Path) -> Path:
    """Vectors of the workspace, in degrees and millimetres that nobody wrote down."""
    time, angle, position = truth()
    sio.savemat(path, {"t": time, "alpha": np.degrees(angle), "pos": 1e3 * position})
    return path


def version_73(path: Path) -> Path:
    """A structure with time in MATLAB's layout of HDF5: user block, classes, references to the values."""
    time, angle, position = truth()

    def put(group: h5py.Group, name: str, values: object, kind: bytes = b"double") -> h5py.Dataset:
        made = group.create_dataset(name, data=values)
        made.attrs["MATLAB_class"] = np.bytes_(kind)
        return made

    with h5py.File(path, "w", userblock_size=512) as file:
        out = file.create_group("out")
        out.attrs["MATLAB_class"] = np.bytes_(b"struct")
        put(out, "time", time[None, :])  # MATLAB's dimensions are reversed
        signals = out.create_group("signals")
        signals.attrs["MATLAB_class"] = np.bytes_(b"struct")
        references = file.create_group("#refs#")
        labels = ["Beam angle (rad)", "Ball position (m)"]
        texts = [np.array([[ord(letter)] for letter in label], dtype=np.uint16) for label in labels]
        for field, items, kind in (
            ("values", [angle[None, :], position[None, :]], b"double"),
            ("label", texts, b"char"),
        ):
            held = [put(references, f"{field}{at}", one, kind).ref for at, one in enumerate(items)]
            signals.create_dataset(field, data=np.array(held, dtype=h5py.ref_dtype)[:, None], dtype=h5py.ref_dtype)
    with path.open("r+b") as stream:
        text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 00:00:00 2024 HDF5 schema 1.00 ."
        stream.write(text.ljust(116) + bytes(8) + b"\x00\x02IM")
    return path


def logsout(path: Path) -> Path:
    """What Simulink logs as a Dataset: angle in degrees with stamps, position in centimetres with an even time."""
    time, angle, position = truth()
    elements = [
        mat.signal("beam angle", mat.timeseries(np.degrees(angle), time, unit="deg")),
        mat.signal(
            "", mat.timeseries(100.0 * position, uniform=(0.0, 0.01, len(time)), unit="cm"), "rig/Ball position"
        ),
    ]
    out = mat.output(tout=time[:, None], logsout=mat.dataset(elements))
    return mat.save(path, {"out": out}, "v7.3" if "73" in path.name else "v7", compressed=False)


def timetable(path: Path) -> Path:
    """A timetable in seconds, as scripts for data acquisition save it."""
    time, angle, position = truth()
    frame = pd.DataFrame({"angle_deg": np.degrees(angle), "x_mm": 1e3 * position}, pd.to_timedelta(time, unit="s"))
    return mat.save(path, {"log": frame})


def workbook(path: Path) -> Path:
    """A German table that begins in B4, in milliseconds, degrees and centimetres."""
    time, angle, position = truth()
    columns = {"Zeit (ms)": 1e3 * time, "Winkel (Grad)": np.degrees(angle), "Abstand [cm]": 100.0 * position}
    pd.DataFrame(columns).to_excel(path, index=False, startrow=3, startcol=1)
    return path


def parquet(path: Path) -> Path:
    """Columns without units, SI."""
    time, angle, position = truth()
    pd.DataFrame({"time": time, "angle": angle, "x": position}).to_parquet(path)
    return path


def tektronix(path: Path) -> Path:
    """MSO and DPO series: a preamble of keys, then TIME and channels; the trigger is in the middle."""
    time, _, _ = truth()
    rows = "".join(f"{t - 6.0:.6e},{a:.4f},{s:.4f}\n" for t, a, s in zip(time, *volts(), strict=True))
    head = (
        "Model,MSO24\nFirmware Version,1.2\n\nPoint Format,Y,\nHorizontal Units,S,\nSample Interval,0.01,\n"
        f"Record Length,{len(time)},\nVertical Units,V,V\n\nLabel,,\nTIME,CH1,CH2\n"
    )
    path.write_text(head + rows)
    return path


def tektronix_channel(path: Path, channel: int) -> Path:
    """TDS series: one channel a file, the preamble in columns beside the data."""
    time, _, _ = truth()
    side = [
        "Record Length,1201", "Sample Interval,1.000000e-02", "Trigger Point,6.00e+02", ",", ",", ",",
        f"Source,CH{channel}", "Vertical Units,V", "Vertical Scale,5.0e-01", "Vertical Offset,0.0",
        "Horizontal Units,s", "Horizontal Scale,1.0e+00", "Pt Fmt,Y", "Yzero,0.0", "Probe Atten,1.0",
        "Model Number,TDS2014B", "Serial Number,C012345", "Firmware Version,FV:v22.11",
    ]  # fmt: skip
    beside = side + [","] * (len(time) - len(side))
    rows = zip(beside, time, volts()[channel - 1], strict=True)
    path.write_text("".join(f"{key},,{t - 6.0:017.12f},{v:10.5f},\n" for key, t, v in rows))
    return path


def rigol(path: Path) -> Path:
    """DS1000 series: samples are counted; start and increment stand behind the names."""
    rows = "".join(f"{at},{a:.4f},{s:.4f},\n" for at, (a, s) in enumerate(zip(*volts(), strict=True)))
    path.write_text("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-6.000000e+00,1.000000e-02,\n" + rows)
    return path


def keysight(path: Path) -> Path:
    """InfiniiVision series: numbered channels, units below."""
    time, _, _ = truth()
    rows = "".join(f"{t:.6E},{a:.5E},{s:.5E}\n" for t, a, s in zip(time, *volts(), strict=True))
    path.write_text("x-axis,1,2\nsecond,Volt,Volt\n" + rows)
    return path


def siglent(path: Path) -> Path:
    """SDS series: units above the names."""
    time, _, _ = truth()
    rows = "".join(f"{t:.9f},{a:.5f},{s:.5f}\n" for t, a, s in zip(time, *volts(), strict=True))
    head = (
        "Record Length,Analog:1201\nSample Interval,Analog:0.01\nVertical Units,CH1:V,CH2:V\n"
        "Vertical Scale,CH1:0.5,CH2:1.0\nVertical Offset,CH1:0.0,CH2:0.0\nHorizontal Units,s\nHorizontal Scale,1\n"
        "Model Number,SDS1104X-E\nSerial Number,SDSMMEBC\nSoftware Version,8.2\nSecond,Volt,Volt\nSource,CH1,CH2\n"
    )
    path.write_text(head + rows)
    return path


def picoscope(path: Path) -> Path:
    """PicoScope: units in brackets in a row of their own, then a blank row; milliseconds."""
    time, _, _ = truth()
    rows = "".join(f"{1e3 * t:.3f},{a:.6f},{s:.6f}\n" for t, a, s in zip(time, *volts(), strict=True))
    path.write_text("Time,Channel A,Channel B\n(ms),(V),(V)\n\n" + rows)
    return path


_LVM_HEAD = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
    "Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tlab\nDate\t2024/05/01\n"
    "Time\t12:00:00,5\n***End_of_Header***\t\n\t\n"
)
_LVM_SEGMENT = (
    "Channels\t2\t\t\nSamples\t{n}\t{n}\t\nDate\t2024/05/01\t2024/05/01\t\nTime\t12:00:00,5\t12:00:00,5\t\n"
    "Y_Unit_Label\tdeg\tmm\t\nX_Dimension\tTime\tTime\t\nX0\t{start}\t{start}\t\nDelta_X\t1,0E-2\t1,0E-2\t\n"
    "***End_of_Header***\t\t\t\nX_Value\tBeam Angle\tBall Position\tComment\n"
)


def labview(path: Path, columns: str = "One", segments: int = 1) -> Path:
    """A measurement file with decimal commas, with one X column or none."""

    def comma(value: float) -> str:
        return f"{value:.6f}".replace(".", ",")

    time, angle, position = truth()
    text = _LVM_HEAD.format(columns=columns)
    for part in np.array_split(np.arange(len(time)), segments):
        text += _LVM_SEGMENT.format(n=len(part), start="0,0E+0" if columns == "One" else comma(float(time[part[0]])))
        for at in part:
            stamp = comma(float(time[at])) if columns == "One" else ""
            text += f"{stamp}\t{comma(float(np.degrees(angle[at])))}\t{comma(1e3 * float(position[at]))}\n"
        text += "\n"
    path.write_text(text)
    return path


def free_text(path: Path) -> Path:
    """A student's program: two lines of words, names, numbers between blanks."""
    time, angle, position = truth()
    rows = zip(time, np.degrees(angle), 100.0 * position, strict=True)
    lines = "".join(f"{t:.3f}  {a:.4f}  {s:.3f}\n" for t, a, s in rows)
    path.write_text("Versuch 3, Wippe\nDatum: 12.5.2024\n\nt    theta   x\n" + lines)
    return path


def serial_monitor(path: Path) -> Path:
    """What a serial monitor saves of labelled values: its clock before each line, and how the program began."""
    time, angle, position = truth()
    lines = ["12:00:00.000 -> Wippe v3", "12:00:00.010 -> calibrating ..."]
    for t, a, s in zip(time, np.degrees(angle), 1e3 * position, strict=True):
        lines.append(f"12:00:{15.0 + t:06.3f} -> TH:{a:.4f},X:{s:.3f},U:{10.0 * a:.1f}")
    path.write_text("\n".join((*lines, "")))
    return path


def labelled(path: Path) -> Path:
    """Labels, values and units between blanks."""
    rows = zip(*truth(), strict=True)
    path.write_text(
        "".join(f"t={t:.3f} s angle={math.degrees(a):.4f} deg pos={100.0 * s:.3f} cm\n" for t, a, s in rows)
    )
    return path


def records(path: Path) -> Path:
    """A record of JSON a line, with objects in it."""
    rows = zip(*truth(), strict=True)
    lines = (
        json.dumps({"t": round(float(t), 3), "beam": {"angle": float(a)}, "ball": {"x": float(s)}}) for t, a, s in rows
    )
    path.write_text("\n".join((*lines, "")))
    return path


def lists(path: Path) -> Path:
    """Lists of JSON by name, below what describes them."""
    time, angle, position = truth()
    columns = {
        "time_s": time.tolist(),
        "angle_deg": np.degrees(angle).tolist(),
        "position_mm": (1e3 * position).tolist(),
    }
    path.write_text(json.dumps({"rig": "beam 2", "gains": [2.0, 0.1], "log": columns}))
    return path


FILES: Mapping[str, tuple[Callable[[Path], Path], tuple[str, ...]]] = {
    "scope.mat": (scope_struct, ("--linkage", f"r={CRANK},L={LEVER}")),
    "vectors.mat": (vectors, ()),
    "v73.mat": (version_73, ()),
    "logsout.mat": (logsout, ()),
    "log73.mat": (logsout, ()),
    "timetable.mat": (timetable, ()),
    "book.xlsx": (workbook, ()),
    "log.parquet": (parquet, ()),
    "tek.csv": (tektronix, SCOPE_OPTIONS),
    "rigol.csv": (rigol, SCOPE_OPTIONS),
    "keysight.csv": (keysight, SCOPE_OPTIONS),
    "siglent.csv": (siglent, SCOPE_OPTIONS),
    "pico.csv": (
        picoscope,
        ("--angle", "Channel A:0.05 rad/V", "--position", "Channel B:0.125 m/V-0.1"),
    ),
    "log.lvm": (labview, ()),
    "free.txt": (free_text, ("--angle", "theta")),
    "monitor.txt": (serial_monitor, ("--angle", "TH:deg")),
    "labels.txt": (labelled, ()),
    "records.jsonl": (records, ()),
    "lists.json": (lists, ()),
}
"""Files by name: who writes them, and what the user has to say."""
