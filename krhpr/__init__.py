"""krhpr."""
