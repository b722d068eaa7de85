"""What all tests share: shared helpers are importable as `rod.helpers`."""

import signal

# A shell begins background jobs with Ctrl-C ignored, and they hand that on to what they begin.
signal.signal(signal.SIGINT, signal.default_int_handler)
