"""The smooth cascade: levels answered one after the other, candidates of a mixture blended."""
