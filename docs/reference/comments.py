"""Prints a header with its comments as doxygen takes them: what stands above a declaration describes it, what
stands behind one too, and the first lines describe the file. The rest of the comments stay as they are."""

import re
import sys

LINE = re.compile(r"^(\s*)// ?(.*)$")
BEHIND = re.compile(r'^(\s*\S[^"]*?(?:"[^"]*"[^"]*?)*)\s//\s(.*)$')


def escaped(text):
    return re.sub(r"([\\@#<>%&])", r"\\\1", text)


def documented(block):
    """Of (indent, text) of one comment. What is set in columns below a line that ends with ':' keeps them."""
    out, before, columns = [], "", False
    for indent, text in block:
        if text.startswith("  ") and (columns or before.endswith(":")) and not text.lstrip().startswith("- "):
            if not columns:
                out.append(f"{indent}/// @verbatim")
            columns = True
            out.append(f"{indent}/// {text}")
        else:
            if columns:
                out.append(f"{indent}/// @endverbatim")
            columns = False
            out.append(f"{indent}/// {escaped(text)}")
        before = text
    if columns:
        out.append(f"{block[-1][0]}/// @endverbatim")
    return out


def described(lines):
    """Lines of the header, each with its comment rewritten."""
    out, number, column = [], 0, None
    while number < len(lines):
        line = lines[number]
        alone = LINE.match(line)
        if alone and column is not None and line.index("//") == column:
            out.append(f"{alone[1]}///< {escaped(alone[2])}")
        elif alone:
            end = number
            while end < len(lines) and LINE.match(lines[end]):
                end += 1
            follows = lines[end].strip() if end < len(lines) else ""
            first = not any(text.strip() for text in out)
            about = follows and not follows.startswith(("}", "#"))
            block = [LINE.match(text).groups() for text in lines[number:end]]
            out.extend(documented(block) if about or first else lines[number:end])
            if first:
                out[0] = "/// @file\n" + out[0]
            number, column = end, None
            continue
        elif behind := BEHIND.match(line):
            out.append(f"{behind[1]} ///< {escaped(behind[2])}")
            column = line.rindex("//")
            number += 1
            continue
        else:
            out.append(line)
        if not alone:
            column = None
        number += 1
    return out


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        print("\n".join(described(file.read().split("\n"))), end="")


if __name__ == "__main__":
    main()
