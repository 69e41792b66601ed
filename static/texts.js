// The page's texts by key: static/texts.json, which webdemo/ui/text/texts.py reads as well.

import texts from "./texts.json" with { type: "json" };

/** The text of a key with values in the place of the names in braces; a key that no text has is given back. */
export function say(key, values = {}) {
  return (texts[key] ?? key).replace(/\{(\w+)\}/g, (name, inner) => values[inner] ?? name);
}
