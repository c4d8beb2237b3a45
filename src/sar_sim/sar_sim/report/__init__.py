"""What a recorded flight comes to: figures of merit, pictures, a page."""
