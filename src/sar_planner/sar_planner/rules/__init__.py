"""Which path is flown at a corner: the paper's rules and the deadbeat rules."""
