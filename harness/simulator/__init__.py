"""A virtual rig: an independent plant, a servo, sensors and a controller, to record experiments with a known truth.

It shares no equation of motion with the models under test: the ball is a rigid body in Cartesian coordinates that the
beam pushes through contact impulses (`contact`), never a reduced equation along the beam.
"""

from harness.simulator.case_folder import truth, write_case
from harness.simulator.channel import Channel
from harness.simulator.effects import UNLISTED, Effects
from harness.simulator.experiment import Experiment, SimulatedRecording
from harness.simulator.imperfections import Imperfections, WornPlace
from harness.simulator.linkage import Linkage
from harness.simulator.moves import DEFLECTION
from harness.simulator.plant import Plant, Run, simulate
from harness.simulator.protocol import Controller, Protocol, Record, Sensors, perform, record, recording_text
from harness.simulator.random_imperfections import KINDS, kinds_of, with_imperfections
from harness.simulator.sensors import Encoder, Laser
from harness.simulator.servo import Servo

__all__ = [
    "DEFLECTION",
    "KINDS",
    "UNLISTED",
    "Channel",
    "Controller",
    "Effects",
    "Encoder",
    "Experiment",
    "Imperfections",
    "Laser",
    "Linkage",
    "Plant",
    "Protocol",
    "Record",
    "Run",
    "Sensors",
    "Servo",
    "SimulatedRecording",
    "WornPlace",
    "kinds_of",
    "perform",
    "record",
    "recording_text",
    "simulate",
    "truth",
    "with_imperfections",
    "write_case",
]
