"""The equations of a ball on a beam: rig, models, effects, integration. No files, no engines, no plots."""

from analytic.compiled import keep_compiled_code_fresh

keep_compiled_code_fresh()
