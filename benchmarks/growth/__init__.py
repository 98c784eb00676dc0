"""How the time of a diagnosis grows with the number and the length of recordings, and against `mujoco.sysid`."""
