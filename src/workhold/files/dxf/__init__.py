"""DXF: drawings read, setups and plates written."""

import logging

# The library tells its logger of each oddity of a file, and as it is loaded of its own affairs; without a handler Python
# would print that.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())
