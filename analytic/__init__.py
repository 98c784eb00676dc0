"""The equations of a ball on a beam: rig, models, effects, integration. No files, no engines, no plots."""
