"""What all tests of the Python module need."""
import signal

# Shells start what runs in the background with Ctrl-C ignored, and Python leaves it so. Tests interrupt what lasts.
signal.signal(signal.SIGINT, signal.default_int_handler)
