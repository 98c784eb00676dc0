"""The rig as URDF, for PyBullet and for anything else that reads it."""
