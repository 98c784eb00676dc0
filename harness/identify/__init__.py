"""Closing the loop: what effect does the model lack, how large is it, and what does the error become with it."""
