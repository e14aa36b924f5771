"""For mkdocs: the C++ API as pages of Doxygen in cpp/ of the site, from the headers that are installed.

Which headers these are stands in CMake alone, as file sets. What Doxygen complains about is an error. Code in comments is
indented by two here, by four in Markdown: the filter adds the rest.
"""

import pathlib
import re
import shutil
import subprocess

from mkdocs.exceptions import PluginError

FILE_SET = re.compile(r'FILE_SET HEADERS BASE_DIRS "[^"]*"\s+FILES\s+([^)]*)\)')
SETTINGS = """
PROJECT_NAME           = "moma, C++"
OUTPUT_DIRECTORY       = "{site}"
HTML_OUTPUT            = cpp
INPUT                  = {headers}
STRIP_FROM_PATH        = "{root}"
FULL_PATH_NAMES        = YES
GENERATE_LATEX         = NO
EXTRACT_ALL            = YES
JAVADOC_AUTOBRIEF      = YES
MARKDOWN_SUPPORT       = YES
AUTOLINK_SUPPORT       = YES
BUILTIN_STL_SUPPORT    = YES
ENABLE_PREPROCESSING   = YES
HAVE_DOT               = NO
DISABLE_INDEX          = NO
GENERATE_TREEVIEW      = YES
SEARCHENGINE           = YES
HTML_TIMESTAMP         = NO
INPUT_FILTER           = "sed 's|^///   |///     |'"
QUIET                  = YES
WARN_IF_UNDOCUMENTED   = NO
WARN_IF_INCOMPLETE_DOC = NO
WARN_AS_ERROR          = FAIL_ON_WARNINGS
"""


def installed_headers(root):
    headers = []
    for folder in ("controller", "controller/config", "plugin"):
        found = FILE_SET.search((root / folder / "CMakeLists.txt").read_text(encoding="utf-8"))
        if not found:
            raise PluginError(f"{folder}/CMakeLists.txt has no file set of headers")
        headers += [root / folder / name for name in found.group(1).split()]
    return headers


def on_post_build(config):
    root = pathlib.Path(config["docs_dir"]).parent
    if shutil.which("doxygen") is None:
        raise PluginError("doxygen is not installed: apt-get install -y --no-install-recommends doxygen")
    headers = " ".join(f'"{path}"' for path in installed_headers(root))
    settings = SETTINGS.format(site=config["site_dir"], root=root, headers=headers)
    made = subprocess.run(["doxygen", "-"], input=settings, capture_output=True, text=True, cwd=root)
    if made.returncode != 0 or made.stderr.strip():
        raise PluginError("doxygen, of the C++ API:\n" + made.stderr.strip())
