// What the page's search finds of acts and runs. Pure, so that Node tests it.

const MOST = 40; // entries that are listed

const plain = (text) => text.normalize("NFD").replace(/\p{Mn}/gu, "").toLowerCase();

/** The entries that have all words of `asked` in their names or what is said of them, the likeliest first. */
export function search(entries, asked) {
  const words = plain(asked).split(/\s+/).filter(Boolean);
  const scored = entries.flatMap((entry) => {
    const [name, more] = [plain(entry.name), plain(`${entry.kind} ${entry.more}`)];
    const scores = words.map((word) => {
      if (name.startsWith(word)) return 0;
      if (name.includes(` ${word}`)) return 1;
      if (name.includes(word)) return 2;
      return more.includes(word) ? 3 : Infinity;
    });
    const score = scores.reduce((sum, value) => sum + value, 0);
    return Number.isFinite(score) ? [{ entry, score }] : [];
  });
  return scored.sort((p, q) => p.score - q.score).slice(0, MOST).map(({ entry }) => entry);
}
