#!/usr/bin/python3
"""Writes argil's man page and its completion for bash from what the program says of itself (--help).

Usage: make_cli_docs.py ARGIL SHARE     → SHARE/man/man1/argil.1, SHARE/bash-completion/completions/argil
"""
import argparse
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

EXIT_CODES = {0: "done", 2: "input refused, or a file to read is not there; nothing written",
              3: "the run failed; its last good state is in the file", 4: "reading or writing failed",
              5: "compare found a difference", 130: "interrupted; the file is whole up to the last record"}


class Entry(NamedTuple):
    """A line of a list: an option, a positional or a subcommand."""

    name: str  # "-o,--output TEXT"
    about: str


class Command(NamedTuple):
    words: list  # after the program's name
    about: str
    usage: str
    lists: dict  # title → entries


def read_lists(lines):
    """Title → entries; an entry's words stand in its line, or in the next one where its name is long."""
    lists, title = {}, None
    for line in lines:
        if re.fullmatch(r"\s*[A-Z][^:\[\]]*:\s*", line):
            title = line.strip().rstrip(":")
            lists.setdefault(title, [])
        elif re.fullmatch(r"\s*\[.*\]\s*", line):
            pass  # that options form a group, and how many of them must be given: the words of each say enough
        elif entry := re.fullmatch(r" {2,4}(\S.*?)(?:\s{2,}(\S.*))?", line):
            lists[title].append(Entry(entry[1], entry[2] or ""))
        elif line.strip() and title:
            last = lists[title][-1]
            lists[title][-1] = last._replace(about=f"{last.about} {line.strip()}".strip())
    return lists


def read_command(argil, words):
    """A command and those below it, in the order of the help."""
    text = subprocess.run([argil, *words, "--help"], capture_output=True, text=True, check=True).stdout
    about, usage, *rest = text.splitlines()
    lists = read_lists(rest)
    below = lists.pop("Subcommands", [])
    commands = [Command(words, about, usage.removeprefix("Usage: "), lists)]
    for entry in below:
        commands += read_command(argil, [*words, entry.name])
    return commands


def escaped(text):
    """Text for roff."""
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"), flags=re.MULTILINE)


def man_page(commands, version):
    page = [f'.TH ARGIL 1 "" "{version}" "User Commands"', ".SH NAME", f"argil \\- {escaped(commands[0].about)}",
            ".SH SYNOPSIS", f".B {escaped(commands[0].usage)}", ".SH COMMANDS"]
    for command in commands[1:]:
        page += [f".SS {escaped(command.usage)}", f"{escaped(command.about[0].upper() + command.about[1:])}."]
        for entries in command.lists.values():
            for entry in entries:
                if not entry.name.startswith("-h,"):
                    page += [".TP", f".B {escaped(entry.name)}", escaped(entry.about)]
    page += [".SH EXIT STATUS"]
    for code, meaning in EXIT_CODES.items():
        page += [".TP", f".B {code}", escaped(meaning)]
    page += [".SH SEE ALSO", "The parameters of a scenario:", ".B argil schema \\-\\-reference"]
    return "\n".join(page) + "\n"


def long_options(command):
    names = " ".join(entry.name for entries in command.lists.values() for entry in entries if entry.name.startswith("-"))
    return sorted(set(re.findall(r"--[a-z][a-z-]*", names)))


def read_pointers(argil):
    """Keys of a scenario that --set takes."""
    page = subprocess.run([argil, "schema", "--reference"], capture_output=True, text=True, check=True).stdout
    return re.findall(r"^\| `(/[^`]+)` \|", page, flags=re.MULTILINE)


def read_devices(argil):
    """Names of the devices, a colon behind those that need more."""
    page = subprocess.run([argil, "devices"], capture_output=True, text=True, check=True).stdout.split("\n\n")[0]
    return [f"{name}:" if name == "plugin" else name for name in re.findall(r"^(\w+) ", page, flags=re.MULTILINE)]


def completion(commands, pointers, devices):
    """Keys after --set, devices after --device; commands and long options by the words before the cursor, otherwise files."""
    cases = []
    for command in commands:
        depth = len(command.words)
        below = [c.words[-1] for c in commands if len(c.words) == depth + 1 and c.words[:depth] == command.words]
        cases.append(f'    "{" ".join(command.words)}") words="{" ".join(below + long_options(command))}" ;;')
    names = "|".join(" ".join(command.words) for command in commands[1:])
    return f"""# bash completion for argil; made from its --help.
_argil() {{
  local cursor=${{COMP_WORDS[COMP_CWORD]}} command="" word words=""
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "${{command:+$command }}$word" in
      {names.replace(" ", chr(92) + " ")}) command="${{command:+$command }}$word" ;;
    esac
  done
  if [[ ${{COMP_WORDS[COMP_CWORD-1]}} == --set ]]; then
    compopt -o nospace 2> /dev/null
    mapfile -t COMPREPLY < <(compgen -S = -W "{" ".join(pointers)}" -- "$cursor")
    return
  elif [[ ${{COMP_WORDS[COMP_CWORD-1]}} == --device || ( $command == devices && $cursor != -* ) ]]; then
    mapfile -t COMPREPLY < <(compgen -W "{" ".join(devices)}" -- "$cursor")
    return
  fi
  case "$command" in
{chr(10).join(cases)}
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cursor"; [[ $cursor == -* ]] || compgen -f -- "$cursor")
}}
complete -o filenames -F _argil argil
"""


def write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("share", type=Path)
    options = parser.parse_args()
    commands = read_command(options.argil, [])
    version = subprocess.run([options.argil, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    write(options.share / "man/man1/argil.1", man_page(commands, version))
    write(options.share / "bash-completion/completions/argil", completion(commands, read_pointers(options.argil), read_devices(options.argil)))


if __name__ == "__main__":
    main()
