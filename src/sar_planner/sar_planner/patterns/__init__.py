"""Search patterns: the legs that they consist of, and what is expected at the end of each."""
