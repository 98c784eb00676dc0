"""What a model may lack: every effect, and all that is known of it, each in one place."""

from analytic.effects.ball import BALL_IMBALANCE, CONTACT_SLIP, ECCENTRIC_PIVOT, ROLLING_RADIUS
from analytic.effects.catalogue import (
    CATALOGUE,
    acting,
    followers_with,
    joined,
    motion_with,
    parameters_with,
    rig_with,
    sensor_with,
    transmission_with,
)
from analytic.effects.drive import (
    ANGLE_GAIN,
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_NONLINEARITY,
    ANGLE_SERVO,
    LINKAGE_BACKLASH,
    beam_in_play,
)
from analytic.effects.effect import Acting, Effect, EngineEntry, Follower, Relations, Transmission
from analytic.effects.force import EffectError, Force
from analytic.effects.parameter import Parameter
from analytic.effects.resistance import (
    DIRECTIONAL_RESISTANCE,
    PRESLIDING_HYSTERESIS,
    QUADRATIC_DRAG,
    ROLLING_RESISTANCE,
    STRIBECK_FRICTION,
    VISCOUS_DAMPING,
)
from analytic.effects.sensor import CHANNEL_DELAY, POSITION_GAIN, POSITION_LAG, POSITION_NONLINEARITY
from analytic.effects.sensor_law import PositionError, SensorLaw
from analytic.effects.track import (
    BEAM_COMPLIANCE,
    LEVEL_DRIFT,
    LEVEL_ERROR,
    LEVEL_PER_RECORDING,
    TRACK_BUMP,
    TRACK_CURVATURE,
)

__all__ = [
    "ANGLE_GAIN",
    "ANGLE_HOLD",
    "ANGLE_LAG",
    "ANGLE_NONLINEARITY",
    "ANGLE_SERVO",
    "BALL_IMBALANCE",
    "BEAM_COMPLIANCE",
    "CATALOGUE",
    "CHANNEL_DELAY",
    "CONTACT_SLIP",
    "DIRECTIONAL_RESISTANCE",
    "ECCENTRIC_PIVOT",
    "LEVEL_DRIFT",
    "LEVEL_ERROR",
    "LEVEL_PER_RECORDING",
    "LINKAGE_BACKLASH",
    "POSITION_GAIN",
    "POSITION_LAG",
    "POSITION_NONLINEARITY",
    "PRESLIDING_HYSTERESIS",
    "QUADRATIC_DRAG",
    "ROLLING_RADIUS",
    "ROLLING_RESISTANCE",
    "STRIBECK_FRICTION",
    "TRACK_BUMP",
    "TRACK_CURVATURE",
    "VISCOUS_DAMPING",
    "Acting",
    "Effect",
    "EffectError",
    "EngineEntry",
    "Follower",
    "Force",
    "Parameter",
    "PositionError",
    "Relations",
    "SensorLaw",
    "Transmission",
    "acting",
    "beam_in_play",
    "followers_with",
    "joined",
    "motion_with",
    "parameters_with",
    "rig_with",
    "sensor_with",
    "transmission_with",
]
