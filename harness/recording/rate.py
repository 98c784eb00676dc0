"""Whether the recorded times are right: the ball's acceleration over the tilt against that of the known rig.

Times that are too long by a factor c make every acceleration c² times too small. Where gravity and the rolling ratio K
are known, this shows in the slope of `tilt_response`. So do a gain of either sensor and, to a lesser degree, friction,
an uneven track, or a ball that slides. The latter leave a part of the motion unexplained, hence the limits below, which
no simulated effect reaches (`docs/reliability.md`); a gain cannot be told from a rate.
"""

from __future__ import annotations

import math

from harness.recording.known_rig import KnownRig
from harness.recording.tilt_response import TiltResponse

LOW = (0.75, 0.95)  # slope over K below, and correlation above, which the times are too long
HIGH = (1.30, 0.995)  # likewise, above, too short: a sliding ball reaches 1.5, with a correlation of 0.99
MIN_T_VALUE = 20.0


def rate_error(response: TiltResponse, rig: KnownRig) -> float | None:
    """Recorded over true time, as it seems; `None` if that seems right, or K is not known."""
    if rig.gravity is None or rig.mass is None or rig.inertia is None or rig.rolling_radius is None:
        return None
    known = 1.0 / (1.0 + rig.inertia / (rig.mass * rig.rolling_radius**2))
    share = response.slope / known
    too_long = share < LOW[0] and response.correlation > LOW[1]
    too_short = share > HIGH[0] and response.correlation > HIGH[1]
    if response.t_value < MIN_T_VALUE or not (too_long or too_short):
        return None
    return math.sqrt(1.0 / share)
