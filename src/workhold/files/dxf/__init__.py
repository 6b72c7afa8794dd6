"""DXF: drawings read, setups and plates written."""

import logging

# The library logs each oddity of a file, and its own affairs as it is loaded; without a handler Python
# would print that.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())
