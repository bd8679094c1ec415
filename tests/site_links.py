"""Every link and picture of the documentation points to something that exists.

usage: site_links.py FOLDER_OR_PAGE...    (links to the web are not followed)
"""

import pathlib
import re
import sys

LINK = re.compile(r"(!?)\[[^\]]*\]\(([^)\s]+)[^)]*\)")
CODE = re.compile(r"^```.*?^```", re.M | re.S)


def anchors(page):
    """The anchors of a page's headings, as GitHub and MkDocs make them."""
    text = CODE.sub("", page.read_text(encoding="utf-8"))
    found = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    for heading in re.findall(r"^#+ (.+)$", text, re.M):
        plain = re.sub(r"[`*_]|\[([^\]]*)\]\([^)]*\)", lambda m: m[1] or "", heading).strip().lower()
        found.add(re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", plain)))
    return found


def faults(page):
    for match in LINK.finditer(CODE.sub(lambda m: "\n" * m[0].count("\n"), page.read_text(encoding="utf-8"))):
        target, _, anchor = match[2].partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        file = (page.parent / target).resolve() if target else page.resolve()
        if not file.exists():
            yield f"{page}: {match[2]} does not exist"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file):
            yield f"{page}: {match[2]}: the page has no such heading"


def main():
    pages = []
    for name in sys.argv[1:]:
        path = pathlib.Path(name)
        pages += sorted(path.rglob("*.md")) if path.is_dir() else [path]
    wrong = [fault for page in pages for fault in faults(page)]
    print("\n".join(wrong) or f"{len(pages)} pages: every link has its target")
    return 1 if wrong or not pages else 0


sys.exit(main())
