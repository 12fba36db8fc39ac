#!/usr/bin/python3
"""The Debian package that `cpack` makes: what it holds works from another root, and it asks for what it needs.

Usage: test_package.py BUILD. It is unpacked, not installed, so that nobody needs to be root. Exit code 77 (skipped)
where Debian's tools for packages are missing. Expected values: Debian's policy of where files lie, and what `ldd` and
dpkg say of the libraries that the program loads.
"""
import gzip
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = os.path.abspath(sys.argv.pop(1))
HAS_PYTHON = Path(BUILD, "python/argil").is_dir()
TOOLS = ("cpack", "dpkg-deb", "dpkg-shlibdeps", "dpkg-query", "ldd")


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="argil_package_")
        run("cpack", "--config", Path(BUILD, "CPackConfig.cmake"), "-B", cls.folder.name)
        (cls.file,) = Path(cls.folder.name).glob("*.deb")
        cls.root = Path(cls.folder.name, "root")
        run("dpkg-deb", "--extract", cls.file, cls.root)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def field(self, name):
        return run("dpkg-deb", "--field", self.file, name).strip()

    def test_it_names_itself_and_its_version(self):
        version = run(self.root / "usr/bin/argil", "--version").split()[1]
        self.assertEqual((self.field("Package"), self.field("Section")), ("argil", "science"))
        self.assertEqual(self.field("Version"), version)
        self.assertEqual(self.field("Architecture"), run("dpkg", "--print-architecture").strip())

    def test_it_depends_on_every_library_that_the_program_loads(self):
        asked = set(re.findall(r"(?:^|, |\| )([a-z0-9.+-]+)", self.field("Depends")))
        loaded = re.findall(r"^\s+(\S+) => (/\S+)", run("ldd", self.root / "usr/bin/argil"), flags=re.MULTILINE)
        # Those that the program names itself; the libraries' own needs are their packages' to ask for.
        named = set(re.findall(r"NEEDED +(\S+)", run("objdump", "-p", self.root / "usr/bin/argil")))
        for name, path in loaded:
            if name not in named:
                continue
            owners = run("dpkg-query", "--search", f"*/{Path(path).name}")
            packages = {words.split(":")[0] for words in owners.splitlines()}
            self.assertTrue(packages & asked, f"{name} of {packages}: Depends asks for {asked}")

    def test_man_page_and_completion_lie_where_debian_looks_for_them(self):
        pages = list((self.root / "usr/share/man/man1").iterdir())
        self.assertEqual([page.name.removesuffix(".gz") for page in pages], ["argil.1"])
        opener = gzip.open if pages[0].suffix == ".gz" else open
        with opener(pages[0], "rt", encoding="utf-8") as page:
            self.assertIn(".SS argil run", page.read())
        if shutil.which("man"):
            self.assertIn("argil run", run("man", pages[0], env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "100"}))
        self.assertTrue((self.root / "usr/share/bash-completion/completions/argil").is_file())

    def test_the_unpacked_program_runs_its_scenarios(self):
        scene = self.root / "usr/share/argil/scenarios/demo_dino_dry.json"
        result = Path(self.folder.name, "out.h5")
        run(self.root / "usr/bin/argil", "run", scene, "-o", result, "--quiet", "--set", "/body/shape/target_tets=300",
            "--set", "/trace/duration_s=0.01")
        self.assertIn("outcome     done", run(self.root / "usr/bin/argil", "info", result))

    @unittest.skipUnless(HAS_PYTHON, "built without the Python package")
    def test_the_unpacked_python_package_reads_what_it_ran(self):
        scene = self.root / "usr/share/argil/scenarios/demo_dino_dry.json"
        script = f"""import argil
settings = {{"/body/shape/target_tets": 300, "/trace/duration_s": 0.01}}
print(argil.run({str(scene)!r}, {str(Path(self.folder.name, "python.h5"))!r}, set=settings).outcome)"""
        said = run("/usr/bin/python3", "-c", script,
                   env={**os.environ, "PYTHONPATH": str(self.root / "usr/lib/python3/dist-packages"),
                        "PYTHONDONTWRITEBYTECODE": "1"})
        self.assertEqual(said, "done\n")
        self.assertIn("python3-numpy", self.field("Recommends"))

    def test_nothing_in_it_names_the_folder_that_it_was_built_in(self):
        for file in self.root.rglob("*"):
            if file.is_file() and file.suffix in (".cmake", ".1", ".md", ".json", ".py", ".so", ""):
                self.assertNotIn(str(Path(BUILD).resolve()).encode(), file.read_bytes(), file)


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        print(f"skipped: no {', '.join(missing)}")
        sys.exit(77)
    unittest.main()
