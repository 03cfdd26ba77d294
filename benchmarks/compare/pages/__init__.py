"""The page: tables, first screen, overview figure, and the papers own figures."""
