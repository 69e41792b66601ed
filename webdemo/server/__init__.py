"""The page for a lab: settings, accounts, a fair queue, history, limits, health and figures."""
