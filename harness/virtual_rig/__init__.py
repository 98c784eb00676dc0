"""A virtual rig: an independent plant, a servo, sensors and a controller, to record experiments with a known truth.

It shares no equation of motion with the models under test: the ball is a rigid body in Cartesian coordinates that the
beam pushes through contact impulses (`contact`), never a reduced equation along the beam.
"""

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
from harness.virtual_rig.sensors import Encoder, Laser
from harness.virtual_rig.servo import Servo

__all__ = [
    "Controller",
    "Encoder",
    "Laser",
    "Plant",
    "Protocol",
    "Record",
    "Run",
    "Sensors",
    "Servo",
    "perform",
    "record",
    "recording_text",
    "simulate",
    "write_recording",
]
