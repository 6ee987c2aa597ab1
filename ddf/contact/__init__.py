"""Contact of sheets with each other and with the tool."""
