"""Everything that is timed: ``python -m webdemo benchmark``."""

PROMPTS = (
    "Two people walk up to each other and shake hands.",
    "One person waves and the other waves back.",
    "Two people dance together.",
    "One person punches and the other steps back.",
)
