"""The rig as a MuJoCo scene."""
