"""What the software costs on a machine."""
