/** A new element with a class and a text, which never becomes markup. */
export function node(tag, className = "", text = "") {
  const made = Object.assign(document.createElement(tag), { className, textContent: text });
  if (tag === "button") made.type = "button"; // and submits nothing
  return made;
}
