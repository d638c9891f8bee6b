#!/usr/bin/env python3
"""Manual pages and shell completion of the program, made from its --help.

usage: share.py PIVNP FOLDER

Writes FOLDER/man/man1/pivnp*.1.gz, FOLDER/bash-completion/completions/pivnp and FOLDER/zsh/vendor-completions/_pivnp.
"""
import gzip
import pathlib
import re
import subprocess
import sys


def helped(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


class Page:
    """The parts of one --help: what it does, usage, and rows (word, text) under their headings."""

    def __init__(self, text):
        lines = text.splitlines()
        self.does, self.usage = lines[0], lines[1].removeprefix("Usage: ")
        self.rows, self.examples, self.more = {}, [], []
        heading, block = None, None
        for line in lines[2:]:
            if re.fullmatch(r"[A-Z][\w ()=]*:", line):
                heading = line[:-1]
                block = self.rows.setdefault(heading, [])
            elif heading == "Examples" and line.startswith("  "):
                self.examples.append(line.strip())
            elif heading and line.startswith("   ") and block:
                block[-1][1] += " " + line.strip()
            elif heading and line.startswith("  "):
                parts = re.split(r"\s{2,}", line.strip(), maxsplit=1)
                block.append([parts[0], parts[1] if len(parts) > 1 else ""])
            elif line.strip():
                heading, block = None, None
                self.more.append(line)
        self.rows.pop("Examples", None)

    def options(self):
        """Long flags with their text and whether they take a value."""
        for word, text in self.rows.get("Options", []):
            flag = re.search(r"--[\w-]+", word)
            yield flag[0], text.strip(), bool(re.search(r"--[\w-]+ \S", word))


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith((".", "\\(aq")) else text


def manual(name, page, version, commands):
    title = name.replace(" ", "-")
    out = [f'.TH {title.upper()} 1 "" "pivnp {version}" "User Commands"', ".SH NAME", f"{roff(title)} \\- {roff(page.does.rstrip('.'))}", ".SH SYNOPSIS",
           f".B {roff(page.usage)}"]
    for heading, rows in page.rows.items():
        out.append(f".SH {heading.upper()}")
        for word, text in rows:
            out += [".TP", f".B {roff(word)}", roff(text.strip())]
    if page.examples:
        out += [".SH EXAMPLES", ".nf", *map(roff, page.examples), ".fi"]
    if page.more:
        out += [".SH NOTES", roff(" ".join(page.more))]
    others = [f"\\fBpivnp\\-{c}\\fR(1)" for c in commands] if name == "pivnp" else ["\\fBpivnp\\fR(1)"]
    return "\n".join(out + [".SH SEE ALSO", ", ".join(others), ""])


def bash(pages, top):
    cases = "\n".join(f"    {name}) options='{' '.join(flag for flag, _, _ in page.options())}' ;;" for name, page in pages.items())
    return f"""# bash completion of pivnp
_pivnp() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} word command='' options
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case $word in -*) ;; *) command=$word; break ;; esac
  done
  case $command in
{cases}
    *) options='{' '.join(pages)} {' '.join(flag for flag, _, _ in top.options())}' ;;
  esac
  case $before in
    --out) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
    --threads|--set) return ;;
  esac
  if [ -z "$command" ] || [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -o filenames -F _pivnp pivnp
"""


def zsh(pages, top):
    def quoted(text):
        return text.replace("'", "'\\''").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")

    def arguments(page):
        specs = [f"'{flag}[{quoted(text)}]{':value:_files' if value else ''}'" for flag, text, value in page.options()]
        return " \\\n        ".join(["_arguments", *specs, "'*:file:_files'"])

    commands = "\n    ".join(f"'{name}:{quoted(page.does)}'" for name, page in pages.items())
    cases = "\n".join(f"      {name})\n        {arguments(page)} ;;" for name, page in pages.items())
    return f"""#compdef pivnp
_pivnp() {{
  local -a commands
  commands=(
    {commands}
  )
  if (( CURRENT == 2 )); then
    _describe command commands
  else
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
{cases}
    esac
  fi
}}
_pivnp "$@"
"""


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    top = Page(helped(program))
    pages = {name: Page(helped(program, name)) for name, _ in top.rows["Subcommands"]}
    texts = {"man/man1/pivnp.1.gz": manual("pivnp", top, version, pages)}
    for name, page in pages.items():
        texts[f"man/man1/pivnp-{name}.1.gz"] = manual(f"pivnp {name}", page, version, pages)
    texts["bash-completion/completions/pivnp"] = bash(pages, top)
    texts["zsh/vendor-completions/_pivnp"] = zsh(pages, top)
    for name, text in texts.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        data = text.encode()
        file.write_bytes(gzip.compress(data, 9, mtime=0) if name.endswith(".gz") else data)


main()
