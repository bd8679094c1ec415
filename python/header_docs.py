"""Writes the comments of C++ headers as a C++ source, so that they are the docstrings of the Python module.

usage: header_docs.py ROOT OUTPUT SOURCE...

Every header_text("HEADER", "SYMBOL") in a SOURCE, or header_text(kHeader, "SYMBOL") in one that defines kHeader, gets the comment of that symbol. SYMBOL is a function or a type, or
TYPE::MEMBER. A symbol without a comment is an error. summary_text(...) is likewise, without the parameters.
"""
import re
import sys
from pathlib import Path


def body_of(lines, owner):
    """The lines of struct or class `owner`."""
    for i, line in enumerate(lines):
        head = re.match(rf"(\s*)(?:struct|class)\s+{owner}\b[^;]*$", line)
        if head:
            end = next(k for k in range(i, len(lines)) if lines[k].startswith(head[1] + "};"))
            return lines[i + 1:end]
    raise LookupError(owner)


def comment_of(lines, symbol):
    owner, _, name = symbol.rpartition("::")
    if owner:
        lines = body_of(lines, owner)
    form = re.compile(rf"^\s*(?!//)(?:(?:struct|class|enum class)\s+{name}\b(?!;)|.*\b{name}\s*(?:\(|;|=|\{{))")
    for i, line in enumerate(lines):
        code, _, trailing = line.partition("///<")
        if not form.match(code):
            continue
        if not trailing and code.rstrip().endswith("="):  # the value is on the next line
            i += 1
            trailing = lines[i].partition("///<")[2]
        if trailing:
            text = [trailing]
            for more in lines[i + 1:]:
                if not more.strip().startswith("///<"):
                    break
                text.append(more.strip()[4:])
            return [t.strip() for t in text]
        above = []
        k = i - 1
        while k >= 0 and (lines[k].strip().startswith("///") or lines[k].strip().startswith("template")):
            if lines[k].strip().startswith("///"):
                above.insert(0, lines[k].strip()[3:].removeprefix(" ").rstrip())
            k -= 1
        if above:
            return above
    raise LookupError(symbol)


def plain(lines):
    """Doxygen's words as plain text."""
    text = "\n".join(lines)
    text = re.sub(r"\\param (\w+)", r"\n\1:", text)
    text = re.sub(r"\\returns?\b", "Returns", text)
    text = re.sub(r"\s*\\throws\b", "\nRaises", text)
    text = re.sub(r"\s*\\pre\b", "\nRequires:", text)
    return text.strip()


def without_parameters(lines):
    """The comment without its \\param paragraphs: the function of Python has other parameters."""
    kept, skipping = [], False
    for line in lines:
        if re.match(r"\s*\\param\b", line):
            skipping = True
        elif re.match(r"\s*\\(returns?|throws|pre)\b", line) or not line.strip():
            skipping = False
        if not skipping:
            kept.append(re.sub(r"\s*\\param\b.*", "", line))
    return kept


def main():
    root, output, sources = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
    wanted = set()
    for source in sources:
        text = Path(source).read_text(encoding="utf-8")
        header = re.search(r'kHeader = "([^"]+)"', text)
        asked = re.findall(r'(header|summary)_text\(\s*(?:kHeader|"([^"]+)"),\s*"([^"]+)"\)', text)
        wanted |= {(named or header[1], symbol, kind == "summary") for kind, named, symbol in asked}
    rows = []
    for header, symbol, summary in sorted(wanted):
        try:
            comment = comment_of((root / header).read_text(encoding="utf-8").splitlines(), symbol)
        except LookupError:
            sys.exit(f"header_docs.py: {header}: there is no comment of {symbol}.")
        text = plain(without_parameters(comment) if summary else comment)
        rows.append(f'    {{"{header}", "{symbol}", {str(summary).lower()}, R"text({text})text"}},\n')
    output.write_text(
        '#include "python/module.hpp"\n\n#include <string_view>\n\nnamespace twincell::python {\n\n'
        "namespace {\nstruct Text {\n  std::string_view header, symbol;\n  bool summary;\n  const char* text;\n};\n"
        f"constexpr Text kTexts[] = {{\n{''.join(rows)}}};\n"
        "const char* found(std::string_view header, std::string_view symbol, bool summary) {\n"
        "  for (const Text& t : kTexts)\n"
        "    if (t.header == header && t.symbol == symbol && t.summary == summary) return t.text;\n"
        '  return "";\n}\n}  // namespace\n\n'
        "const char* header_text(std::string_view header, std::string_view symbol) {\n"
        "  return found(header, symbol, false);\n}\n"
        "std::string summary_text(std::string_view header, std::string_view symbol) {\n"
        "  return found(header, symbol, true);\n}\n\n}  // namespace twincell::python\n", encoding="utf-8")


main()
