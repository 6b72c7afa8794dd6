"""The page and its HTTP interface: ``holdfast serve``."""
