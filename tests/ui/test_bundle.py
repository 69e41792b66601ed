"""Modules in one script."""

from __future__ import annotations

import re
from pathlib import Path

from webdemo.ui.bundle import bundled
from webdemo.ui.frames import FIRST


def test_each_module_comes_once_after_what_it_imports(tmp_path: Path) -> None:
    (tmp_path / "words.json").write_text('{"a": 1}')
    (tmp_path / "one.js").write_text("export default { b: 2 };\nexport const here = import.meta.url;\n")
    (tmp_path / "two.js").write_text('import * as all from "./one.js";\nexport async function sum() {}\n')
    words = 'import words from "./words.json" with { type: "json" };\n'
    (tmp_path / "main.js").write_text(f'import {{ sum }} from "./two.js";\nimport one from "./one.js";\n{words}')
    made = bundled([tmp_path / "main.js"], lambda path: f"/at/{path.name}")
    lines = ["const exported = { b: 2 };", 'const here = "/at/one.js";', "return { default: exported, here };"]
    lines += ["const all = module2;", "async function sum() {}", "return { sum };", 'const exported = {"a": 1};']
    lines += ["const { sum } = module1;", "const one = module2.default;", "const words = module3.default;"]
    lines += ['window.pdModules = { "/at/main.js": module0 };']
    assert [made.count(line) for line in lines] == [1] * len(lines)
    assert sorted(map(made.index, lines)) == list(map(made.index, lines)), "what is imported stands before"
    page = bundled([part.template.parent / part.module for part in FIRST], str)
    assert not re.search(r"^(import|export) |import\.meta|</script", page, re.MULTILINE)
