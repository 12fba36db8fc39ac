#!/usr/bin/python3
"""What `cmake --install` leaves works without the project: the program, its pages, find_package(argil) and the Python
package.

Usage: test_install.py BUILD. The example of examples/press_ball, a project in C++ alone, is built against the installed
libraries, and its hand is replayed from a trace by the installed program: the same forces. Exit code 77 (skipped)
without h5py.
"""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

ROOT = Path(__file__).resolve().parents[2]
BALL = ROOT / "tests/golden/ball.json"
BUILD = os.path.abspath(sys.argv.pop(1))
HAS_PYTHON = Path(BUILD, "python/argil").is_dir()


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="argil_install_")
        cls.prefix = Path(cls.folder.name, "usr")
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_example_feels_what_a_trace_of_its_motion_feels(self):
        build, trace = Path(self.folder.name, "build"), Path(self.folder.name, "down.csv")
        run("cmake", "-S", ROOT / "examples/press_ball", "-B", build, "-DCMAKE_BUILD_TYPE=Release",
            f"-DCMAKE_PREFIX_PATH={self.prefix}")
        run("cmake", "--build", build)
        seen = np.loadtxt(run(build / "press_ball", BALL).splitlines(), delimiter=",", skiprows=1)
        start = np.loadtxt(ROOT / "tests/golden/rub.csv", delimiter=",", skiprows=1)[0, 1:]
        rows = [f"{tick / 1000:.3f},{start[0]:.9f},{start[1]:.9f},{start[2] - 0.2e-3 * tick:.9f}\n" for tick in range(51)]
        trace.write_text("t,x,y,z\n" + "".join(rows))
        result = Path(self.folder.name, "down.h5")
        run(self.prefix / "bin/argil", "run", BALL, "--trace", trace, "-o", result, "--quiet")
        with h5py.File(result) as file:
            force = np.linalg.norm(file["haptic/force"][:], axis=1)[4::5]
        self.assertGreater(force[-1], 1.0)
        np.testing.assert_allclose(seen[:, 1], force, rtol=1e-4, atol=1e-4)  # printed digits, summed steps

    @unittest.skipUnless(HAS_PYTHON, "built without the Python package")
    def test_python_imports_what_is_installed_and_computes_the_same_bits(self):
        packages = self.prefix / "lib/python3/dist-packages"
        (local,) = self.prefix.glob("lib/python3.*/dist-packages")  # where Debian's Python looks in /usr/local
        script = f"""import site
site.addsitedir({str(local)!r})
import argil, argil.plot
from os.path import realpath
assert realpath(argil.__file__).startswith(realpath({str(packages)!r})), argil.__file__
result = argil.run({str(BALL)!r}, "python.h5")
argil.plot.save(argil.plot.water(result), "water")
print(argil.build())"""
        said = run("/usr/bin/python3", "-c", script, cwd=self.folder.name,
                   env={**os.environ, "MPLBACKEND": "Agg", "PYTHONDONTWRITEBYTECODE": "1"})
        program = self.prefix / "bin/argil"
        self.assertEqual(said.strip(), run(program, "--version").strip())
        run(program, "run", BALL, "-o", "program.h5", "--quiet", cwd=self.folder.name)
        self.assertIn("equal", run(program, "compare", "program.h5", "python.h5", cwd=self.folder.name))
        self.assertTrue(Path(self.folder.name, "water.png").is_file())

    def test_the_man_page_names_every_command(self):
        page = Path(self.prefix, "share/man/man1/argil.1").read_text(encoding="utf-8")
        for command in ("run", "export", "sweep collect"):
            self.assertIn(f".SS argil {command} [OPTIONS]", page)

    def test_the_completion_offers_commands_and_options(self):
        script = f"""source '{self.prefix}/share/bash-completion/completions/argil'
            COMP_WORDS=(argil sweep co) COMP_CWORD=2; _argil; echo "${{COMPREPLY[0]}}"
            COMP_WORDS=(argil export --h) COMP_CWORD=2; _argil; echo "${{COMPREPLY[@]}}" """
        self.assertEqual(run("bash", "-c", script, cwd=self.folder.name), "collect\n--help --html\n")

    def test_the_completion_offers_devices_and_keys(self):
        script = f"""source '{self.prefix}/share/bash-completion/completions/argil'
            COMP_WORDS=(argil live a.json --device "") COMP_CWORD=4; _argil; echo "${{COMPREPLY[@]}}"
            COMP_WORDS=(argil devices h) COMP_CWORD=2; _argil; echo "${{COMPREPLY[@]}}"
            COMP_WORDS=(argil run a.json --set /material/y) COMP_CWORD=4; _argil; echo "${{COMPREPLY[@]}}" """
        self.assertEqual(run("bash", "-c", script, cwd=self.folder.name),
                         "simulated haply spacenav plugin:\nhaply\n/material/youngs_modulus_Pa=\n")

    def test_scenarios_run_from_where_they_are_installed(self):
        run(self.prefix / "bin/argil", "validate", self.prefix / "share/argil/scenarios/demo_dino_wet.json")


if __name__ == "__main__":
    unittest.main()
