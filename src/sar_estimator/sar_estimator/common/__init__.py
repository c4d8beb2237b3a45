"""What all packages share: poses, states, geodesy, topics, conversions, what a node needs."""
