"""The paper's results and this project's beside them."""
