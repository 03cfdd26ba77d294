"""Every experiment of paper and thesis, and the document of results."""
