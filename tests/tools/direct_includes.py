#!/usr/bin/env python3
"""Sources include the standard headers of what they name, themselves or by the header of the same name, and reach the
headers of moma whose constants they name: where several sources are compiled as one, another's headers would do.

  direct_includes.py ROOT FOLDER...      says what is missing, as FILE: <HEADER> for NAME, in FOLDER...; of constants, in all
  direct_includes.py --self-test         proves that it notices
"""

import re
import sys
from pathlib import Path

# Names that belong to one header alone.
NAMES = {
    "algorithm": r"(?:sort|clamp|find_if|any_of|all_of|none_of|max_element|min_element|min|max|count_if|lower_bound)\(",
    "array": r"(?:array<|to_array)",
    "chrono": r"chrono::",
    "cmath": r"(?:sqrt|sin|cos|atan2|hypot|isfinite|isinf|pow|exp|floor|ceil|lround|remainder|cbrt)\(",
    "cstdint": r"u?int(?:8|16|32|64)_t\b",
    "filesystem": r"filesystem::",
    "fstream": r"[io]fstream\b",
    "functional": r"function<",
    "limits": r"numeric_limits<",
    "map": r"map<",
    "memory": r"(?:unique_ptr|shared_ptr|make_unique|make_shared)\b",
    "numbers": r"numbers::",
    "optional": r"optional<",
    "set": r"set<",
    "span": r"span<",
    "stdexcept": r"(?:runtime_error|invalid_argument|logic_error|out_of_range)\b",
    "string": r"(?:string\b|to_string\()",
    "string_view": r"string_view\b",
    "utility": r"(?:move|pair|swap|exchange|as_const)\b",
    "variant": r"(?:variant<|visit\()",
    "vector": r"vector<",
}


def missing(text, own):
    """(header, name) for each that neither `text` nor the file's own header includes."""
    included = set(re.findall(r"#include <([^>]+)>", text + own))
    code = code_of(text)
    for header, name in NAMES.items():
        used = re.search(r"\bstd::" + name, code)
        if used and header not in included:
            yield header, used.group(0)


def code_of(text):
    return re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"', "", text)


def unreached(texts):
    """(file, header, name) for each constant of a header in `texts` (path: text) that a source names and does not reach."""
    homes = {}
    for file, text in texts.items():
        if file.endswith(".h"):
            for name in re.findall(r"^(?:inline )?constexpr [^=({;]*?\b(k[A-Z]\w*)", code_of(text), re.M):
                homes.setdefault(name, set()).add(file)
    for file, text in sorted(texts.items()):
        if not file.endswith(".cc"):
            continue
        reached, ahead = set(), [file]
        while ahead:
            here = ahead.pop()
            if here not in reached and here in texts:
                reached.add(here)
                ahead += re.findall(r'#include "([^"]+)"', texts[here])
        code = code_of(text)
        own = set(re.findall(r"(?:constexpr|const)\b[^;=]*?\b(k[A-Z]\w*)", code))
        own.update(name for body in re.findall(r"\benum\b[^}]*", code) for name in re.findall(r"k[A-Z]\w*", body))
        for name in sorted(set(re.findall(r"(?<![.\w:])k[A-Z]\w*", code)) - own):
            if name in homes and not homes[name] & reached:
                yield file, min(homes[name]), name


def check(root, folders):
    ours = ("controller", "world", "eval", "reports", "plugin", "python", "bench", "tests")
    files = [file for folder in ours for end in ("h", "cc") for file in (root / folder).rglob(f"*.{end}")]
    texts = {str(file.relative_to(root)): file.read_text() for file in files if "node_modules" not in file.parts}
    found = [f"{file}: {header} for {name}" for file, header, name in unreached(texts)]
    for folder in folders:
        for file in sorted((root / folder).rglob("*.cc")):
            header = file.with_suffix(".h")
            own = header.read_text() if header.exists() else ""
            for name, used in missing(file.read_text(), own):
                found.append(f"{file.relative_to(root)}: <{name}> for {used}")
    return found


def self_test():
    assert not list(missing("#include <vector>\nstd::vector<int> v;", ""))
    assert not list(missing("std::vector<int> v;", "#include <vector>"))
    assert not list(missing('// std::vector<int>\nauto s = "std::vector<int>";', ""))
    assert list(missing("std::vector<int> v;", "#include <string>")) == [("vector", "std::vector<")]
    assert list(missing("auto x = std::max(1, 2);", "")) == [("algorithm", "std::max(")]
    texts = {
        "a.h": "inline constexpr double kHigh = 1;\nconstexpr std::array<int, 2> kTwo = {};",
        "b.h": '#include "a.h"',
        "reaches.cc": '#include "b.h"\nreturn kHigh;',
        "does_not.cc": "return kHigh + kTwo[0];",
        "has_its_own.cc": "constexpr double kHigh = 2;\nenum class E { kTwo };\nreturn kHigh + Other::kTwo;",
    }
    assert list(unreached(texts)) == [("does_not.cc", "a.h", "kHigh"), ("does_not.cc", "a.h", "kTwo")]
    for header in NAMES:
        assert re.fullmatch(r"[a-z_]+", header), header


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        sys.exit(0)
    problems = check(Path(sys.argv[1]), sys.argv[2:])
    print(*problems, sep="\n", end="\n" if problems else "")
    sys.exit(1 if problems else 0)
