"""Prompts that the page offers; each is one that the default model does well."""

EXAMPLES: tuple[tuple[str, str], ...] = (
    ("Handshake", "Two people walk up to each other and shake hands."),
    ("Bow", "Two people bow to each other."),
    ("High five", "Two people give each other a high five."),
    ("Hug", "One person walks up to the other and they hug."),
    ("Punch", "One person punches and the other steps back."),
    ("Kick", "One person kicks and the other dodges the kick."),
    ("Push", "One person pushes the other, who stumbles back."),
    ("Wave", "One person waves and the other waves back."),
    ("Hand over", "One person hands an object to the other."),
    ("Dance", "Two people dance facing each other."),
)
"""(what the chip says, the prompt it puts into the box)"""
