// For pages that a browser opened from a disk, where it loads no modules: their sources stand before this in the same
// file (webdemo/ui/site.py), and each becomes an address that holds it.

const imports = Object.fromEntries(
  Object.entries(globalThis.pasDeDeuxModules).map(([name, source]) => [name, `data:text/javascript;charset=utf-8,${encodeURIComponent(source)}`]),
);
document.head.append(Object.assign(document.createElement("script"), { type: "importmap", textContent: JSON.stringify({ imports }) }));
import("pas-de-deux/share/share.js");
