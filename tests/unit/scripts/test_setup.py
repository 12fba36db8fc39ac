#!/usr/bin/python3
"""What scripts/setup installs and scripts/build configures: among programs that only write down how they were called."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PACKAGES = "# words\n[program]\ncmake\n\n# words\nlibone-dev\nfound bash\n[tour]\nlibpage-dev\n[rest]\nlibtest-dev\n[peers]\nlibother-dev\n"
STAND_INS = {
    "apt-get": 'echo "apt-get $*" >>calls.log',
    "sudo": '"$@"',
    "dpkg-query": '[[ " ${INSTALLED:-} " != *" ${!#} "* ]] || printf "ii "',
    # Writes the cache's one line that scripts/build reads.
    "cmake": 'echo "cmake $*" >>calls.log; [[ $1 == --build ]] || '
             '{ mkdir -p build; last=${!#}; echo "BUILD_TESTING:BOOL=${last##*=}" >build/CMakeCache.txt; }',
}


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="argil_setup_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name in "scripts", "bin":
            (self.folder / name).mkdir()
        for name in "setup", "build":
            shutil.copy(ROOT / "scripts" / name, self.folder / "scripts")
        (self.folder / "scripts/packages.txt").write_text(PACKAGES)
        for name, text in STAND_INS.items():
            file = self.folder / "bin" / name
            file.write_text(f"#!/usr/bin/env bash\n{text}\n")
            file.chmod(0o755)

    def call(self, *words, installed=""):
        """Exit code and what was called, package lists' updates aside."""
        log = self.folder / "calls.log"
        log.unlink(missing_ok=True)
        done = subprocess.run([self.folder / words[0], *words[1:]], capture_output=True, text=True, check=False,
                              env={**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
                                   "INSTALLED": installed})
        calls = log.read_text().splitlines() if log.is_file() else []
        return done.returncode, [words for words in calls if "update" not in words]

    def installed_by(self, *words, installed=""):
        code, calls = self.call(*words, installed=installed)
        self.assertEqual(code, 0)
        return [words.partition("--no-install-recommends ")[2] for words in calls if words.startswith("apt-get")]

    def test_the_group_of_the_program_or_all_is_installed_where_it_is_missing(self):
        self.assertEqual(self.installed_by("scripts/setup", "program"), ["cmake libone-dev"])
        self.assertEqual(self.installed_by("scripts/setup"), ["cmake libone-dev libpage-dev libtest-dev"])
        self.assertEqual(self.installed_by("scripts/setup", "tour"), ["cmake libone-dev libpage-dev"])
        self.assertEqual(self.installed_by("scripts/setup", "program", installed="cmake libone-dev"), [])
        self.assertEqual(self.installed_by("scripts/setup", "peers"), ["libother-dev"])
        self.assertEqual(self.installed_by("scripts/setup", installed="cmake libone-dev"), ["libpage-dev libtest-dev"])

    def test_another_group_is_refused(self):
        self.assertEqual(self.call("scripts/setup", "tests"), (2, []))

    def test_the_program_is_built_without_the_tests_and_its_folder_takes_them_later(self):
        program, everything = "apt-get install --yes --quiet --no-install-recommends cmake libone-dev", "cmake --build build"
        argil = "cmake --build build --target argil"
        self.assertEqual(self.call("scripts/build", "argil"),
                         (0, [program, "cmake --preset release -DBUILD_TESTING=OFF", argil]))
        self.assertEqual(self.call("scripts/build", "argil"), (0, [program, argil]))
        self.assertEqual(self.call("scripts/build"),
                         (0, [program + " libpage-dev libtest-dev", "cmake --preset release -DBUILD_TESTING=ON", everything]))
        self.assertEqual(self.call("scripts/build", "argil", "unit_base"),
                         (0, [program + " libpage-dev libtest-dev", "cmake --build build --target argil unit_base"]))
        self.assertEqual(self.call("scripts/build", "argil"), (0, [program, argil]))

    def test_the_tour_is_built_without_the_tests_also_where_the_program_was_built_before(self):
        program, three = "apt-get install --yes --quiet --no-install-recommends cmake libone-dev", ("argil", "viewer", "python")
        configured, built = "cmake --preset release -DBUILD_TESTING=OFF", "cmake --build build --target argil viewer python"
        self.call("scripts/build", "argil")
        self.assertEqual(self.call("scripts/build", *three), (0, [program + " libpage-dev", configured, built]))
        cache = self.folder / "build/CMakeCache.txt"
        cache.write_text(cache.read_text() + "pybind11_DIR:PATH=/usr/lib/cmake/pybind11\n")
        self.assertEqual(self.call("scripts/build", *three), (0, [program + " libpage-dev", built]))

    def test_the_projects_list_has_each_package_once_and_what_the_tests_alone_need_apart(self):
        text = (ROOT / "scripts/packages.txt").read_text()
        parts = re.split(r"\[\w+\]\n", text)[1:]
        names = [[line.split()[0] for line in part.splitlines() if line and line[0] != "#"] for part in parts]
        self.assertEqual(len(set(sum(names, []))), len(sum(names, [])))
        self.assertTrue({"cmake", "libsuitesparse-dev", "python3-vtk9"} <= set(names[0]))
        self.assertTrue({"pybind11-dev", "nodejs"} <= set(names[1]))
        self.assertTrue({"libgtest-dev", "chromium", "slurm-wlm"} <= set(names[2]))
        self.assertIn("libbullet-dev", names[3])


if __name__ == "__main__":
    unittest.main()
