"""The paper's rules, enclosed by interval arithmetic."""
