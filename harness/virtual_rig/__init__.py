"""A virtual rig: an independent plant, a servo, sensors and a controller, to record experiments with a known truth.

It shares no equation of motion with the models under test: the ball is a rigid body in Cartesian coordinates that the
beam pushes through contact impulses (`contact`), never a reduced equation along the beam.
"""

from harness.virtual_rig.case_folder import truth, write_case
from harness.virtual_rig.channel import Channel
from harness.virtual_rig.effects import CATALOGUE, UNLISTED, Effects
from harness.virtual_rig.experiment import Experiment, SimulatedRecording
from harness.virtual_rig.linkage import Linkage
from harness.virtual_rig.plant import Plant, Run, simulate
from harness.virtual_rig.protocol import (
    Controller,
    Protocol,
    Record,
    Sensors,
    perform,
    record,
    recording_text,
    write_recording,
)
from harness.virtual_rig.replay import Replay
from harness.virtual_rig.sensors import Encoder, Laser
from harness.virtual_rig.servo import Servo

__all__ = [
    "CATALOGUE",
    "UNLISTED",
    "Channel",
    "Controller",
    "Effects",
    "Encoder",
    "Experiment",
    "Laser",
    "Linkage",
    "Plant",
    "Protocol",
    "Record",
    "Replay",
    "Run",
    "Sensors",
    "Servo",
    "SimulatedRecording",
    "perform",
    "record",
    "recording_text",
    "simulate",
    "truth",
    "write_case",
    "write_recording",
]
