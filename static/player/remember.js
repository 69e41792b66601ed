// What a browser tab keeps for a reload.

/** Marks this tab as one that has made something, which a reload then brings back (ui/tabs/history.py). */
export function remember() {
  try {
    sessionStorage.setItem("pas-de-deux-made", "1");
  } catch {
    // a browser may keep nothing; a reload then begins anew
  }
}
