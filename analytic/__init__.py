"""The equations of a ball on a beam: rig, models, integration. No files, no engines, no plots."""
