"""Two bodies that touch: embraces, hands that are held or meet, and what keeps bodies and arms out of each other."""
