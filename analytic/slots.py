"""Slots of the kernel's parameter vector, shape (SLOTS,), by name.

Accelerations are per unit of (1 + J/(m ρ²)). The first block is the model's; the others are zero unless an effect
(`analytic.effects`) writes them.
"""

GRAVITY, CENTRIFUGAL, ECCENTRIC, LEVEL, LINEAR, READING, FRICTION_GAIN, TRANSITION = range(8)
RESPONSE, HEIGHT, WEIGHT = 8, 9, 10  # k [1], h + r [m], g [m/s²]: for the normal force and forces on the ball
VISCOUS, QUADRATIC = 11, 12  # [1/s], [1/m]
DRY_PLUS, DRY_MINUS, DRY_STATIC, STRIBECK_VELOCITY = 13, 14, 15, 16  # [1], [1], excess [1], [m/s]
CURVATURE, CURVATURE_CENTRE, COMPLIANCE = 17, 18, 19  # [1/m], [m], [rad/m]
BUMP_HEIGHT, BUMP_CENTRE, BUMP_WIDTH = 20, 21, 22  # [m]
IMBALANCE, PHASE, ORIGIN, ROLL = 23, 24, 25, 26  # [m/s²], φ₀ [rad], s where φ = 0 [m], 1/r [1/m]
TRACTION, TURN = 27, 28  # μ R/r [1], 0 for a ball that cannot slip; r [m]
DAHL, DAHL_STIFFNESS = 29, 30  # c [1], k σ/m [1/s²]
SHAPE, SHAPE_LOW, SHAPE_STEP, SHAPE_COUNT, SHAPE_NODES = range(31, 36)  # a spline term: `analytic.law.spline_term`
MOST_NODES = 96
SLOTS = SHAPE_NODES + MOST_NODES
# Each force law of a user's own effect has a block behind the slots, so that runs without any cost nothing more: what
# it depends on, first node, distance of nodes, then the nodes, with two more beyond either end for slopes.
LAW_NODES, LAW_MARGIN = 513, 2
LAW_SLOTS = 3 + LAW_NODES + 2 * LAW_MARGIN
