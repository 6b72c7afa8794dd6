"""Start of the add-on without a window; everything of it is imported when it is used."""
