"""What a command leaves behind when it is interrupted, killed, or when disk, worker or engine fails it."""
