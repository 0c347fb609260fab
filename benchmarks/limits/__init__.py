"""What the processor could do at best, and how much of it is used: instructions, operations, ports."""
