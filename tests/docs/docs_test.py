"""What the pages of the documentation say is true of the repository and of the program.

  docs_test.py links ROOT              every relative link and image of every page leads somewhere, anchors included; all pages are in the site
  docs_test.py commands ROOT MOMA      every command line of moma in the pages is one that the program understands
  docs_test.py tutorials ROOT BUILD    the tutorials, done as they say in a folder of their own, with few trials
  docs_test.py snippets ROOT MOMA      every block of YAML is what the program takes, of JSON a case that it solves, of Python what Python reads
  docs_test.py site ROOT               scripts/docs.sh builds the site, with every name of the Python package and every C++ class that is installed
  docs_test.py self-test ROOT MOMA     the first two notice what is wrong
"""

import glob
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

SKIPPED = {"node_modules", "tests", "results"}
FENCE = re.compile(r"^( *)```(\w*)[^\n]*\n(.*?)^\1```", re.S | re.M)


def pages(root):
    """All pages of the repository, those of installed packages and of builds apart."""
    for page in sorted(root.rglob("*.md")):
        folders = page.relative_to(root).parts[:-1]
        if not any(part in SKIPPED or part.startswith((".", "build")) for part in folders):
            yield page


def without_code(text):
    return re.sub(r"`(?:[^`\n]|\n(?!\n))*`", "", FENCE.sub("", text))


def anchors(page):
    """The anchors of a page's headings, as GitHub and the site make them."""
    found = {}
    for heading in re.findall(r"^#+ +(.*?) *$", FENCE.sub("", page.read_text()), re.M):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", plain.lower()).strip().replace(" ", "-")
        count = found.get(name, 0)
        found[name] = count + 1
        if count:
            found[f"{name}-{count}"] = 1
    return set(found)


def check_links(root):
    wrong, links = [], 0
    for page in pages(root):
        for target in re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text())):
            if re.match(r"[a-z]+:", target):
                continue
            links += 1
            path, _, anchor = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            if not file.exists():
                wrong.append(f"{page.relative_to(root)}: {target} leads nowhere")
            elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                wrong.append(f"{page.relative_to(root)}: {target}: the page has no such heading")
    return wrong, links


def check_navigation(root):
    """Every page of the site is in its navigation; studies are found from docs/index.md as well."""
    listed = set(re.findall(r": (\S+\.md)$", (root / "mkdocs.yml").read_text(), re.M))
    linked = {target.partition("#")[0] for target in re.findall(r"\]\(([^)\s]+)\)", (root / "docs/index.md").read_text())}
    names = {page.relative_to(root / "docs").as_posix() for page in (root / "docs").rglob("*.md")}
    wrong = [f"docs/{name} is not in the nav of mkdocs.yml" for name in sorted(names - listed)
             if not (name.startswith("studies/") and name in linked)]
    return wrong + [f"mkdocs.yml: nav names docs/{name}, which is not there" for name in sorted(listed - names)]


def shell_lines(block):
    """The lines of a block for a shell, continued ones joined."""
    return [line.strip() for line in block.replace("\\\n", " ").splitlines() if line.strip()]


def invocations(line):
    """The argument lists of moma, the program, in a line of a shell (not of python3 -m moma)."""
    for match in re.finditer(r"(?:^|(?<!-m)[\s(])(?:build/)?moma (?!_)", line):
        if re.search(r"\bman +$", line[: match.start() + 1]):
            continue
        lexer = shlex.shlex(line[match.end():], posix=True, punctuation_chars="();<>|&")
        lexer.whitespace_split = True
        words = []
        for word in lexer:
            if re.fullmatch(r"[();<>|&]+", word):
                break
            words.append(word)
        if words:
            yield words


def run(moma, words, folder, seconds=120):
    return subprocess.run([str(moma), *words], cwd=folder, capture_output=True, text=True, timeout=seconds,
                          stdin=subprocess.DEVNULL)


def check_commands(root, moma):
    """Blocks are tried in an empty folder: inputs are missing there, but a line that the program does not understand is
    another complaint. Of what stands in running text, command and options have to exist."""
    wrong, lines = [], 0
    helps = {}

    def options_of(command):
        if command not in helps:
            shown = run(moma, ["help", command], root)
            helps[command] = set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", shown.stdout)) if shown.returncode == 0 else None
        return helps[command]

    with tempfile.TemporaryDirectory() as folder:
        tried = set()
        for page in pages(root):
            text, name = page.read_text(), page.relative_to(root)
            if name.name == "CHANGELOG.md":
                continue  # of options as they were
            for _, language, block in FENCE.findall(text):
                if language not in ("sh", "yaml"):
                    continue
                for line in shell_lines(block):
                    for words in invocations(line) if language == "sh" or line.startswith("- run:") else []:
                        lines += 1
                        if tuple(words) in tried:
                            continue
                        tried.add(tuple(words))
                        done = run(moma, words, folder)
                        if "see moma" in done.stderr or "unknown command" in done.stderr:
                            wrong.append(f"{name}: {line}\n    {done.stderr.strip()}")
            for span in re.findall(r"`(?:build/)?moma ([^`]+)`", FENCE.sub("", text)):
                words = re.split(r"[\s=]+", span)
                lines += 1
                known = options_of(words[0]) if not words[0].startswith("-") and words[0] != "COMMAND" else set()
                if known is None:
                    wrong.append(f"{name}: `moma {span}`: there is no command {words[0]}")
                    continue
                for word in words[1:]:
                    if re.fullmatch(r"--?[a-zA-Z][\w-]*", word) and known and word not in known:
                        wrong.append(f"{name}: `moma {span}`: {words[0]} has no option {word}")
    return wrong, lines


# What a tutorial's command gets in addition, so that it takes a second.
FEWER = {
    "run": ["--trials", "4", "--set", "simulation.time_limit=10"],
    "check": ["--no-time", "--worlds", "4"],
    "tune": ["--set", "tune.budget.trials=60", "--set", "tune.worlds=6", "--set", "tune.held_out={count: 6, seed: 1007}",
             "--set", "tune.racing=none", "--set", "tune.confirm=none", "--set", "tune.sensitivity=none",
             "--set", "simulation.time_limit=10"],
}
ELSEWHERE = ("scripts/setup.sh", "cmake --build build")  # what has been done where this test runs


def do_tutorial(page, root, build):
    """The files that a page has one save, and the commands of its blocks, in their order."""
    text, commands = page.read_text(), 0
    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)
        shutil.copytree(root / "configs", here / "configs")
        (here / "build").symlink_to(build)
        if (root / ".venv").exists():
            (here / ".venv").symlink_to(root / ".venv")
        (here / "reports").mkdir()
        if "results/first.db" in text and "first.yaml" not in text:  # goes on from the first tutorial
            do_first = re.search(r"Save this as\s+`([^`]+)`:\s+```yaml\n(.*?)```", (page.parent / "first-run.md").read_text(), re.S)
            (here / do_first.group(1)).write_text(do_first.group(2))
            run(here / "build/moma", ["run", do_first.group(1), *FEWER["run"]], here)
        for match in FENCE.finditer(text):
            language, block = match.group(2), match.group(3)
            before = text[: match.start()].rstrip()
            saved = re.search(r"Save this as\s+`([^`]+)`:$", before)
            if language == "yaml" and saved:
                (here / saved.group(1)).write_text(block)
            elif language == "cpp":
                source = root / "examples/first_controller/first_controller.cc"
                if block != source.read_text():
                    return f"{page.name}: its source is not that of {source.relative_to(root)}", commands
            elif language == "sh":
                for line in shell_lines(block):
                    if line.startswith(ELSEWHERE):
                        continue
                    if not line.startswith("build/moma "):
                        return f"{page.name}: not a command of this test: {line}", commands
                    words = []
                    for word in shlex.split(line, comments=True)[1:]:
                        words += [os.path.relpath(file, here) for file in glob.glob(str(here / word))] or [word]
                    more = ["--max-shapes", "1"] if "--fit-shapes" in words else FEWER.get(words[0], [])
                    done = run(here / "build/moma", [*words, *more], here)
                    commands += 1
                    if done.returncode != 0:
                        return f"{page.name}: {line}\n    ended with {done.returncode}: {done.stderr.strip()}", commands
                    if "-o" in words and not (here / words[words.index("-o") + 1]).exists():
                        return f"{page.name}: {line}\n    wrote no such file", commands
    return None, commands


# What a snippet of a suite leaves out.
SUITE = {
    "robot": "../robots/frankie.yaml",
    "controllers": "{holistic: ../controllers/holistic.yaml}",
    "worlds": "{seed: 1, families: {open: {}}}",
    "simulation": "{mode: kinematic, time_limit: 1}",
    "trials": "2",
}
OWN_PROGRAMS = re.compile(r": no file \S+/(libmine\.so|other|mine)$")  # of who reads the page


def complaint_about_yaml(block, here, moma):
    """What the program says against a suite, a robot or a controller in a page; None where it takes it."""
    keys = re.findall(r"^([A-Za-z_]\w*):", block, re.M)
    suite, more = here / "configs/suites/snippet.yaml", ""
    if {"urdf", "sensors"} & set(keys):
        (here / "configs/robots/snippet.yaml").write_text(block)
        done = run(moma, ["robot", "configs/robots/snippet.yaml"], here)
        return None if done.returncode == 0 else done.stderr.strip()
    if re.match(r" +\w+: \{method:", block):  # one controller of a suite's
        block, keys = "controllers:\n" + block, ["controllers"]
    if not set(keys) & {*SUITE, "disturbances", "sweep", "tune", "metrics", "success"}:
        include = "" if "include" in keys or "method" in keys else "include: moma.yaml\n"
        (here / "configs/controllers/snippet.yaml").write_text(include + block)
        block, keys = "controllers: {snippet: ../controllers/snippet.yaml}\n", ["controllers"]
    if "sweep" in keys and "controller." in block and "controllers" not in keys:
        more = "controllers: {holistic: ../controllers/holistic.yaml}\n"
    suite.write_text(block + more + "".join(f"{key}: {value}\n" for key, value in SUITE.items()
                                            if key not in keys and f"{key}:" not in more))
    done = run(moma, ["check", suite, "--no-time", "--worlds", "1"], here)
    said = done.stderr.strip()
    return None if done.returncode == 0 or OWN_PROGRAMS.search(said) else said


def check_snippets(root, moma):
    wrong, count = [], 0
    urdf = sorted(root.glob(".venv/lib/python3*/site-packages/cmeel.prefix/share/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf"))
    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)
        shutil.copytree(root / "configs", here / "configs")
        if (root / ".venv").exists():
            (here / ".venv").symlink_to(root / ".venv")
        (here / "configs/my_robot").mkdir()
        own = re.search(r"```python\n(class Mine:.*?)```", (root / "docs/how-to/python-controller.md").read_text(), re.S)
        (here / "configs/suites/mine.py").write_text(own.group(1))
        if urdf:
            (here / "configs/robots/my_robot.urdf").symlink_to(urdf[0])
        for page in pages(root):
            name, text = page.relative_to(root), page.read_text()
            if name.parts[:2] in (("docs", "tutorials"), ("docs", "studies")):
                continue  # tutorials are done as a whole; studies tell of files that were
            for match in FENCE.finditer(text):
                language, block = match.group(2), match.group(3)
                said = None
                if language == "yaml" and not block.startswith("- ") and (urdf or "my_robot.urdf" not in block):
                    said = complaint_about_yaml(block, here, moma)
                elif language == "json":
                    (here / "configs/case.json").write_text(block)
                    done = run(moma, ["solve", "configs/case.json"], here)
                    said = done.stderr.strip() if done.returncode else None
                elif language == "python":
                    try:
                        compile(block, str(name), "exec")
                    except SyntaxError as error:
                        said = str(error)
                else:
                    continue
                count += 1
                if said:
                    line = text[: match.start()].count("\n") + 1
                    wrong.append(f"{name}:{line}: {said}")
    return wrong, count


def check_site(root):
    """Skipped (77) where the site's generators are not installed: this test fetches nothing."""
    installed = root / ".venv-docs/.installed-requirements"
    if shutil.which("doxygen") is None or not installed.exists() or installed.read_text() != (root / "requirements-docs.txt").read_text():
        print("doxygen or the wheels of scripts/docs.sh are not installed")
        sys.exit(77)
    made = subprocess.run([root / "scripts/docs.sh"], capture_output=True, text=True)
    if made.returncode != 0:
        return [f"scripts/docs.sh ended with {made.returncode}:\n{made.stderr}"], 0
    site, wrong, names = root / "build/site", [], 0
    page = (site / "reference/python-api.html").read_text()
    for name in re.search(r"__all__ = \[(.*?)\]", (root / "python/moma/__init__.py").read_text(), re.S).group(1).split(","):
        if name.strip():
            names += 1
            if not re.search(rf'id="moma\.(\w+\.)?{name.strip().strip(chr(34))}"', page):
                wrong.append(f"reference/python-api.html has no {name.strip()}")
    for folder in ("controller", "controller/config", "plugin"):
        headers = re.search(r'FILE_SET HEADERS BASE_DIRS "[^"]*"\s+FILES([^)]*)\)', (root / folder / "CMakeLists.txt").read_text()).group(1)
        for header in headers.split():
            names += 1
            if not list((site / "cpp").glob(f"{pathlib.Path(header).stem.replace('_', '__')}_8h.html")):
                wrong.append(f"cpp/ has no page of {folder}/{header}")
    for file in re.findall(r'href="\.\./(cpp/[^"]+)"', (root / "docs/reference/cpp-api.md").read_text()):
        names += 1
        if not (site / file).exists():
            wrong.append(f"docs/reference/cpp-api.md: the site has no {file}")
    return wrong, names


def self_test(root, moma):
    with tempfile.TemporaryDirectory() as folder:
        fake = pathlib.Path(folder)
        (fake / "a.md").write_text("# One heading\n[gone](b.md) [here](#one-heading) [not](#two) ![](c.png)\n"
                                   "```sh\nbuild/moma run x.yaml --sed 3\nmoma rnu x.yaml  # no command\n"
                                   "moma run x.yaml --seed 3\n```\n`moma query DB --fromat csv` `moma query DB --format csv`\n")
        wrong_links, links = check_links(fake)
        wrong_lines, lines = check_commands(fake, moma)
        shutil.copytree(root / "configs", fake / "configs")
        (fake / "docs/how-to").mkdir(parents=True)
        (fake / "docs/how-to/python-controller.md").write_text("```python\nclass Mine:\n    pass\n```\n```python\nmoma.(\n```\n")
        (fake / "a.md").write_text("```yaml\ntrials: 3\n```\n```yaml\ntrails: 3\n```\n```json\n{}\n```\n```yaml\nk_epsilom: 1\n```\n")
        wrong_snippets, snippets = check_snippets(fake, moma)
    ok = snippets == 6 and len(wrong_snippets) == 4
    for word in ("python-controller.md:5:", "a.md:4:", "a.md:7:", "k_epsilom"):
        ok &= sum(word in text for text in wrong_snippets) == 1
    ok &= links == 4 and lines == 5
    for word in ("b.md leads nowhere", "#two: the page has no such heading", "c.png leads nowhere"):
        ok &= sum(word in text for text in wrong_links) == 1
    for word in ("--sed", "rnu", "has no option --fromat"):
        ok &= sum(word in text.split("\n")[0] for text in wrong_lines) == 1
    ok &= len(wrong_links) == 3 and len(wrong_lines) == 3
    if not ok:
        print("\n".join([f"{links} links, {lines} lines, {snippets} snippets", *wrong_links, *wrong_lines, *wrong_snippets]))
    return 0 if ok else 1


def main():
    what, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    if what == "self-test":
        return self_test(root, pathlib.Path(sys.argv[3]).resolve())
    if what == "tutorials":
        wrong, count = [], 0
        for page in sorted((root / "docs/tutorials").glob("*.md")):
            complaint, commands = do_tutorial(page, root, pathlib.Path(sys.argv[3]).resolve())
            count += commands
            if complaint:
                wrong.append(complaint)
    elif what == "links":
        wrong, count = check_links(root)
        wrong += check_navigation(root)
    elif what == "snippets":
        wrong, count = check_snippets(root, pathlib.Path(sys.argv[3]).resolve())
    elif what == "site":
        wrong, count = check_site(root)
    else:
        wrong, count = check_commands(root, pathlib.Path(sys.argv[3]).resolve())
    least = {"links": 100, "commands": 80, "tutorials": 15, "snippets": 25, "site": 30}[what]
    if count < least:
        wrong.append(f"only {count} {what} were found, not {least}")
    print("\n".join(wrong) if wrong else f"{count} {what}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
