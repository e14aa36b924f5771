"""For mkdocs: links of the pages that lead out of docs/, to sources and examples, point into the repository.

The pages are read as files of the repository too, where such a link is a path. On the site it becomes the file's address
in the repository that MOMA_REPOSITORY names (https://HOST/OWNER/NAME/blob/BRANCH), or plain text without one.
"""

import os
import pathlib
import re

LINK = re.compile(r"\[([^\]]*)\]\(((?:\.\./)+[^)#\s]+)(#[^)]*)?\)")


def on_page_markdown(markdown, page, config, files):
    docs = pathlib.Path(config["docs_dir"])
    root = docs.parent
    repository = os.environ.get("MOMA_REPOSITORY", "").rstrip("/")

    def lead_out(match):
        target = pathlib.Path(os.path.normpath(docs / pathlib.Path(page.file.src_uri).parent / match.group(2)))
        if docs in target.parents or not target.exists():  # of the site, or broken: mkdocs says so
            return match.group(0)
        if not repository:
            return match.group(1)
        return f"[{match.group(1)}]({repository}/{target.relative_to(root).as_posix()}{match.group(3) or ''})"

    return LINK.sub(lead_out, markdown)
