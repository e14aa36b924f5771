#!/usr/bin/env python3
"""Sources include the standard headers of what they name, themselves or by the header of the same name, and reach the
headers of moma whose constants and functions they name: where several sources are compiled as one, another's would do.

  direct_includes.py ROOT FOLDER...      says what is missing, as FILE: <HEADER> for NAME, in FOLDER...; of moma's own, in all
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


# At the beginning of a line, where namespaces have what they declare. Functions have an underscore in their names here,
# which tells them from most of what else is followed by a parenthesis.
CONSTANT = re.compile(r"^(?:inline )?constexpr [^=({;]*?\b(k[A-Z]\w*)", re.M)
FUNCTION = re.compile(r"^(?!return|else|#|using|typedef)(?:\[\[\w+\]\] )?[A-Za-z_][\w:<>,&* ]*[ &*]([a-z]\w*_\w+)\(", re.M)


def unreached(texts):
    """(file, header, name) for each constant or function of a header in `texts` (path: text) that a source names and does
    not reach."""
    homes = {}
    for file, text in texts.items():
        if file.endswith(".h"):
            for pattern in (CONSTANT, FUNCTION):
                for name in pattern.findall(code_of(text)):
                    homes.setdefault(name, set()).add(file)
    for file, text in sorted(texts.items()):
        if not file.endswith(".cc"):
            continue
        reached, ahead = set(), [file]
        while ahead:
            here = ahead.pop()
            if here not in reached and here in texts:
                reached.add(here)
                for header in re.findall(r'#include "([^"]+)"', texts[here]):
                    ahead += [header, str(Path(here).parent / header)]
        code = code_of(text)
        own = set(re.findall(r"(?:constexpr|const)\b[^;=]*?\b(k[A-Z]\w*)", code))
        own.update(name for body in re.findall(r"\benum\b[^}]*", code) for name in re.findall(r"k[A-Z]\w*", body))
        own.update(FUNCTION.findall(code))
        own.update(re.findall(r"^ +[A-Za-z_][\w:<>,&*]* +[&*]?([a-z]\w*_\w+)\([^;]*?\)[^;]*?\{", code, re.M))
        own.update(re.findall(r"[\w>&*] [&*]?([a-z]\w*_\w+)\s*[,);={]", code))  # parameters and variables
        own.update(re.findall(r"\b(?:auto|function<.*?>) *&?([a-z]\w*_\w+) *[=(]", code))
        used = set(re.findall(r"(?<![.\w:])k[A-Z]\w*", code)) | set(re.findall(r"(?<![.\w:>~])([a-z]\w*_\w+)\(", code))
        for name in sorted(used - own):
            if name in homes and not homes[name] & reached:
                yield file, min(homes[name]), name


def check(root, folders):
    ours = ("controller", "world", "eval", "reports", "plugin", "python", "bench", "tests")
    files = [file for folder in ours for end in ("h", "cc") for file in (root / folder).rglob(f"*.{end}")]
    others = {"node_modules", "install"}  # other people's, and users of the installed library
    texts = {str(file.relative_to(root)): file.read_text() for file in files if not others & set(file.parts)}
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
        "x/a.h": "inline constexpr double kHigh = 1;\nconstexpr std::array<int, 2> kTwo = {};\nint least_of(int a);",
        "x/b.h": '#include "a.h"',
        "reaches.cc": '#include "x/b.h"\nreturn least_of(kHigh);',
        "does_not.cc": "  return kHigh + kTwo[0] + least_of(3);",
        "has_its_own.cc": "constexpr double kHigh = 2;\nenum class E { kTwo };\nint least_of(int b) {\n"
        "  return kHigh + Other::kTwo + it.least_of(3) + least_of(4);\n}",
    }
    assert [name for file, _, name in unreached(texts) if file == "does_not.cc"] == ["kHigh", "kTwo", "least_of"]
    assert {file for file, _, _ in unreached(texts)} == {"does_not.cc"}
    for header in NAMES:
        assert re.fullmatch(r"[a-z_]+", header), header


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        sys.exit(0)
    problems = check(Path(sys.argv[1]), sys.argv[2:])
    print(*problems, sep="\n", end="\n" if problems else "")
    sys.exit(1 if problems else 0)
