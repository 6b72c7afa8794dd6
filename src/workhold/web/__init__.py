"""The page and its HTTP interface: ``workhold serve``."""
