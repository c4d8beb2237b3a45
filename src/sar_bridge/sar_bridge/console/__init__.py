"""The operator's page: what it shows is pure; the page itself is a shell."""
