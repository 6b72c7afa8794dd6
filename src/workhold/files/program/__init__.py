"""Programs of machines (RS-274, G-code) and tables of their tools."""
