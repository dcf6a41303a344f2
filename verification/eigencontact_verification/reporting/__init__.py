"""Reports of verification: verdicts in words, tables, pages and their sections, progress, facts of the machine."""
