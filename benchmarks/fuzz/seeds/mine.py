"""An effect of a user's own."""

import numpy as np

from analytic.effects import Effect, Force, Parameter

MINE = Effect(
    name="mine",
    law="F = F₀ sin s",
    parameters=(Parameter("size", "N", -1.0, 1.0, 0.1),),
    source="a made-up law",
    force=Force("position", lambda s, size: size * np.sin(s)),
)
