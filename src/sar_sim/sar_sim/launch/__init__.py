"""Starting the nodes of a flight."""
