"""All experiments of the paper and the thesis, and the document with their results."""
